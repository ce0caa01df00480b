// SPDX-License-Identifier: Apache-2.0
// The robot's state from a driver on ROS. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/config/settings/ros2_lane.hpp"
#include "components/ros2_lane/robot_joints.hpp"
#include "components/ros2_lane/tf_tree.hpp"

namespace handsel::ros2_lane {

/// Gathers joints, and places the base at a fixed pose or where TF has the base frame.
class JointInput {
 public:
  /// `robot` must outlive this.
  JointInput(const RobotModel& robot, const settings::Ros2LaneSettings& settings);

  /// Sets where the base is when no base frame is named, world frame.
  void set_base(const Pose& T_world_base) { T_world_base_ = T_world_base; }
  /// Takes a message and returns the robot's state, or nullopt while joints or the base are not
  /// known.
  std::optional<RobotState> on(const ros2::JointState& message, TimePoint arrival,
                               const TfTree& tree);
  /// Returns what is missing at `now` once a message has come, one sentence; empty: nothing.
  std::string trouble(TimePoint now) const;

 private:
  settings::Ros2LaneSettings settings_;
  JointGatherer joints_;
  Pose T_world_base_{Pose::Identity()};
  bool received_{false};
  bool base_known_{true};  ///< False: the base has no transform, or an old one.
};

}  // namespace handsel::ros2_lane
