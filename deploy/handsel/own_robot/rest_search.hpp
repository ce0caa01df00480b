// SPDX-License-Identifier: Apache-2.0
// Searches a rest configuration: the hand before the base, fingers down, elbow high. Own method.
#pragma once

#include <optional>

#include "common/model/robot_model.hpp"

namespace handsel {

/// Size of an arm in its base frame.
struct ArmSize {
  Vector3 shoulder{Vector3::Zero()};  ///< origin of the second joint, root frame [m]
  double reach{};                     ///< max distance from the shoulder to the grasp frame [m]
};

/// Returns the size of the arm of a robot with the group "arm". `T_tool_grasp`: grasp frame of the
/// hand in the tool link.
ArmSize size_of_arm(const RobotModel& robot, const Pose& T_tool_grasp);

/// Where the hand may be at rest, as fractions of the reach, and what counts in the choice.
struct RestSettings {
  std::vector<double> ahead{0.40, 0.50, 0.60};    ///< of the grasp frame before the shoulder
  std::vector<double> above{-0.20, -0.05, 0.10};  ///< of the grasp frame above the shoulder
  double limit_weight{1.0};   ///< of the distance to the nearest limit, as a fraction of the range
  double height_weight{1.0};  ///< of the height of the lowest link of the arm [1/m]
  double turn_weight{0.05};   ///< against large angles [1/rad]
};

/// Returns the configuration of all axes with the best weighted sum. `tool_direction`: in which the
/// hand reaches, tool frame, unit. nullopt: the arm reaches none
/// of the poses without touching itself; `robot.rest_configuration()` gives the other axes.
std::optional<Vector> find_rest(const RobotModel& robot, const Pose& T_tool_grasp,
                                const Vector3& tool_direction, const RestSettings& settings = {});

}  // namespace handsel
