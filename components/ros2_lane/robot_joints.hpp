// SPDX-License-Identifier: Apache-2.0
// Between joints by name, as ROS has them, and axes in order, as the robot model has them. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/messages/ros2.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::ros2_lane {

/// Returns the state with the axes' names; without velocities or efforts where the state has none.
ros2::JointState joint_state_of(const RobotModel& robot, const RobotState& state);

/// The robot's links below its root, which is below `world`, at this configuration.
void add_links(const RobotModel& robot, const RobotState& state, const std::string& world,
               std::vector<ros2::Transform>& out);

/// Gathers a robot's state from JointState messages, each of some of the joints. A velocity that is
/// not reported is taken from the last two positions. Forces are not known to it.
class JointGatherer {
 public:
  JointGatherer(const RobotModel& robot, double max_age);

  /// Takes in the axes that a message names; joints the robot does not have, and messages without
  /// positions, are left out.
  void on(const ros2::JointState& message, TimePoint arrival);
  /// Nullopt while an axis is not known or its news is too old.
  std::optional<RobotState> state(TimePoint now);
  /// The axes that are missing now, for people; empty: none.
  std::string missing(TimePoint now) const;

 private:
  struct Reported {
    double position{}, velocity{};
    Stamp stamp{};
    std::optional<TimePoint> arrival;
  };
  const RobotModel& robot_;
  Duration max_age_;
  std::vector<Reported> axes_;
  std::uint64_t sequence_{0};
  Stamp stamp_{0};
};

}  // namespace handsel::ros2_lane
