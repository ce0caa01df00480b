// From a goal of a person to a task of the domain, or to the reason why it is refused. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

/// A goal in terms of the domain.
struct TaskQuery {
  int task{-1};
  std::vector<std::string> args;
  std::string reason;        ///< why it is refused, and what would make it possible; empty: it is not
  std::string unseen;        ///< a thing or a person that is named and not seen; empty: all are
  bool needs_person{false};  ///< somebody is meant and nobody is there
};

/// "give mug to anna", "take what anna offers", ...
std::string text_of(const TaskGoal& goal);

TaskQuery query_for(const TaskGoal& goal, const Domain& domain, const World& world, const Scene& scene);

/// Before anything is done: it is so already; empty: it is not.
std::string already(const TaskGoal& goal);

}  // namespace handsel::supervisor
