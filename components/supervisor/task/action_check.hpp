// Whether planned actions can be done, have shown their effects and still make sense in a state.
// Pure.
#pragma once

#include <string>
#include <vector>

#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

/// Why an action cannot be done in this state; empty: it can.
std::string why_not(const Domain& domain, World& world, const PlannedAction& action,
                    const State& state);
/// Changes the state by the effects of the action, whose conditions are not tested.
void apply(const Domain& domain, World& world, const PlannedAction& action, State& state);
/// Returns whether all that the action adds holds already.
bool shows(const Domain& domain, World& world, const PlannedAction& action, const State& state);
/// Which condition that must hold while it runs does not; empty: all do.
std::string broken(const Domain& domain, World& world, const PlannedAction& action,
                   const State& state);
/// Which condition of a task that was done does not hold; empty: all do.
std::string unachieved(const Domain& domain, World& world, int task,
                       const std::vector<std::string>& args, const State& state);

}  // namespace handsel::supervisor
