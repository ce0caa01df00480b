// From a goal and the facts to actions. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "common/messages/world.hpp"

namespace handsel::supervisor {

struct PlannedAction {
  ActionKind kind{};
  std::string object, human, surface;
  std::string text() const;  ///< "give mug to anna"
};

struct TaskPlan {
  std::vector<PlannedAction> actions;
  std::string reason;        ///< why the goal cannot be pursued; empty when it can
  bool needs_person{false};  ///< somebody is meant and nobody is there yet
};

/// Starts from what is already so: an object in the robot's hand is not picked again.
TaskPlan plan_task(const TaskGoal& goal, const Facts& facts);

/// What is left to do when `failed` failed: the robot does not stand there with an object in its hand. `home` is the surface the object
/// came from.
std::vector<PlannedAction> recover(const PlannedAction& failed, bool holding, const std::string& home);

}  // namespace handsel::supervisor
