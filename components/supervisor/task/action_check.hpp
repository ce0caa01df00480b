// SPDX-License-Identifier: Apache-2.0
// Checks conditions and effects of planned actions in a state. Pure.
#pragma once

#include <string>
#include <vector>

#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

/// Returns why an action cannot be done in this state; empty: it can.
std::string why_not(const Domain& domain, World& world, const PlannedAction& action,
                    const State& state);
/// Applies the effects of the action to the state without a test of its conditions.
void apply(const Domain& domain, World& world, const PlannedAction& action, State& state);
/// Returns whether all added atoms of the action hold already.
bool shows(const Domain& domain, World& world, const PlannedAction& action, const State& state);
/// Returns the violated condition of the running action; empty: none.
std::string broken(const Domain& domain, World& world, const PlannedAction& action,
                   const State& state);
/// Returns the violated condition of a finished task; empty: none.
std::string unachieved(const Domain& domain, World& world, int task,
                       const std::vector<std::string>& args, const State& state);

}  // namespace handsel::supervisor
