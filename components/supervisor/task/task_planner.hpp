// SPDX-License-Identifier: Apache-2.0
// Converts a person's goal to a task of the domain, or to the reason of its refusal. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

/// A goal in terms of the domain.
struct TaskQuery {
  int task{-1};                   ///< index in Domain::tasks; -1: the domain has none
  std::vector<std::string> args;  ///< of the task; "-": left out
  std::string reason;             ///< why the goal is refused, and a remedy; empty: accepted
  std::string unseen;             ///< named object or person that is not observed; empty: none
  bool needs_person{false};       ///< whether a person is needed but none is observed
};

/// "give mug to anna", "take what anna offers", ...
std::string text_of(const TaskGoal& goal);

/// Resolves the names of the goal with the objects, surfaces and people of the world. The result
/// has a reason if a name is missing, unknown or of the wrong type.
TaskQuery query_for(const TaskGoal& goal, const Domain& domain, const World& world,
                    const Scene& scene);

/// Returns that the goal holds already before any action, one phrase; empty: it does not.
std::string already(const TaskGoal& goal);

}  // namespace handsel::supervisor
