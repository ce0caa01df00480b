// From a goal of a person to a task of the domain, or to the reason why it is refused. Pure.
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
  std::string unseen;             ///< thing or person that is named and not seen; empty: none
  bool needs_person{false};       ///< a person is needed and none is seen
};

/// "give mug to anna", "take what anna offers", ...
std::string text_of(const TaskGoal& goal);

/// Resolves the names of the goal against the objects, surfaces and people of the world. The result
/// has a reason when a name is missing, unknown or of the wrong type.
TaskQuery query_for(const TaskGoal& goal, const Domain& domain, const World& world,
                    const Scene& scene);

/// Before anything is done: it is so already; empty: it is not.
std::string already(const TaskGoal& goal);

}  // namespace handsel::supervisor
