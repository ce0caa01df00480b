// SPDX-License-Identifier: Apache-2.0
// Which part of the robot each axis belongs to. Pure.
#pragma once

#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::trajectory_controller {

/// Part of the robot.
enum class Part : char { arm, hand, head, platform };

/// How far outside its bounds an axis may be measured [rad, m].
struct BoundNoise {
  double axis{0.02};    ///< by noise
  double finger{0.05};  ///< by what presses on a finger
};

/// Robot groups "hand" and "head" may be missing. All other axes are moved by trajectories alone; a
/// trajectory may move those of hands and head too.
class AxisGroups {
 public:
  /// Keeps a reference to the robot.
  explicit AxisGroups(const RobotModel& robot, const BoundNoise& noise = {});

  /// Axes that trajectories alone move, in increasing order; of a robot that drives the last three
  /// are those of its platform.
  const std::vector<int>& arm() const noexcept { return arm_; }
  /// Axes that trajectories alone move, without those of the platform; in increasing order.
  const std::vector<int>& arm_joints() const noexcept { return arm_joints_; }
  /// Axes of the platform: x, y, heading; empty for a robot that does not drive.
  const std::vector<int>& platform() const noexcept { return platform_; }
  /// Axes of the head, in the order of its group.
  const std::vector<int>& head() const noexcept { return head_; }
  /// Returns the part an axis belongs to; `axis` is not checked.
  Part part(int axis) const noexcept { return parts_[static_cast<std::size_t>(axis)]; }
  /// Returns the number of axes of the robot.
  int size() const noexcept { return static_cast<int>(parts_.size()); }
  /// Returns a measured position as one inside the axis' bounds, unless it is outside by more than
  /// noise, or of a finger by more than what presses on it may bend it [rad, m].
  double inside(int axis, double position) const noexcept;

 private:
  const RobotModel& robot_;
  BoundNoise noise_;
  std::vector<Part> parts_;  // of each axis
  std::vector<int> arm_, arm_joints_, platform_, head_;
};

}  // namespace handsel::trajectory_controller
