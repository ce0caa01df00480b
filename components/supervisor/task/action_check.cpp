// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/action_check.hpp"

#include <algorithm>

#include "components/supervisor/task/grounding.hpp"

namespace handsel::supervisor {
namespace {

/// Returns what the first condition among `conditions` that does not hold says about the action;
/// empty: all hold.
std::string objection(const Domain& domain, World& world, const PlannedAction& planned,
                      const State& state, std::vector<Test> CompiledAction::*conditions,
                      const char* otherwise) {
  const CompiledAction& action = domain.actions[static_cast<std::size_t>(planned.action)];
  const Frame frame = frame_of(world, planned.args);
  const Ground ground{world};
  const Test* test = failing(ground, action.*conditions, frame, state);
  if (test == nullptr) return "";
  return test->otherwise.empty()
             ? planned.text() + otherwise
             : ground.fill(test->otherwise, action.parameters, action.types, frame);
}

}  // namespace

std::string why_not(const Domain& domain, World& world, const PlannedAction& planned,
                    const State& state) {
  return objection(domain, world, planned, state, &CompiledAction::when,
                   " is not possible any more");
}

void apply(const Domain& domain, World& world, const PlannedAction& planned, State& state) {
  change(Ground{world}, domain.actions[static_cast<std::size_t>(planned.action)],
         frame_of(world, planned.args), state);
}

bool shows(const Domain& domain, World& world, const PlannedAction& planned, const State& state) {
  const CompiledAction& action = domain.actions[static_cast<std::size_t>(planned.action)];
  const Frame frame = frame_of(world, planned.args);
  const Ground ground{world};
  return std::all_of(action.adds.begin(), action.adds.end(),
                     [&](const Literal& l) { return ground.holds(l, frame, state); });
}

std::string broken(const Domain& domain, World& world, const PlannedAction& planned,
                   const State& state) {
  return objection(domain, world, planned, state, &CompiledAction::keep,
                   " makes no sense any more");
}

std::string unachieved(const Domain& domain, World& world, int task,
                       const std::vector<std::string>& args, const State& state) {
  const CompiledTask& t = domain.tasks[static_cast<std::size_t>(task)];
  const Frame frame = frame_of(world, args);
  const Ground ground{world};
  const Test* test = failing(ground, t.achieved, frame, state);
  if (test == nullptr) return "";
  return test->otherwise.empty() ? "not all of it was done"
                                 : ground.fill(test->otherwise, t.parameters, t.types, frame);
}

}  // namespace handsel::supervisor
