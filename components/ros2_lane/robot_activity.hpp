// SPDX-License-Identifier: Apache-2.0
// Latest reports of what the robot does, and whether it may take a motion now. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/messages/execution.hpp"
#include "common/messages/task.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::ros2_lane {

/// Keeps the newest status of the task, of the controller and of the running trajectory.
class RobotActivity {
 public:
  /// Takes the newest status of the task's action; while it runs, motions are refused.
  void on(const ActionStatus& status) { action_ = status; }
  /// Takes the newest status of the controller: epoch, and whether the command runs.
  void on(const ExecutionStatus& status) { execution_ = status; }
  /// Takes the robot's motion now.
  void on(const ActiveTrajectory& active, TimePoint arrival);
  /// Returns an empty text where a motion of `arm` may begin at `now`, else why not. `max_age`: of
  /// the robot's motion [s].
  std::string why_not_ready(const Group& arm, TimePoint now, double max_age) const;
  /// Returns the newest motion; there must have been one, as where why_not_ready() was empty.
  const ActiveTrajectory& active() const { return *active_; }
  /// Returns the newest status of the controller; there must have been one.
  const ExecutionStatus& execution() const { return *execution_; }

 private:
  std::optional<ActionStatus> action_;
  std::optional<ExecutionStatus> execution_;
  std::optional<ActiveTrajectory> active_;
  TimePoint active_at_{};
};

}  // namespace handsel::ros2_lane
