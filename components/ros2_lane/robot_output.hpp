// SPDX-License-Identifier: Apache-2.0
// The robot's joints and frames, and the objects' frames, as ROS has them. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/config/settings/ros2_lane.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/ros2.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::ros2_lane {

/// Keeps the newest state and scene, and converts both.
class RobotOutput {
 public:
  /// `robot` must outlive this.
  RobotOutput(const RobotModel& robot, const settings::Ros2LaneSettings& settings)
      : robot_(robot), settings_(settings) {}

  /// Takes the newest state; that of another robot is left out.
  void on(const RobotState& state);
  /// Takes the newest scene.
  void on(const Scene& scene) { scene_ = scene; }
  /// Returns the joints; nullopt while no state is known.
  std::optional<ros2::JointState> joints() const;
  /// Returns the transforms that are known: root link and objects in the world frame of the
  /// settings, other links in their parent's.
  ros2::Transforms frames() const;
  /// Returns the parent of each of the robot's links below the root, by link.
  std::map<std::string, std::string> link_parents() const;

 private:
  const RobotModel& robot_;
  settings::Ros2LaneSettings settings_;
  std::optional<RobotState> state_;
  std::optional<Scene> scene_;
};

}  // namespace handsel::ros2_lane
