// SPDX-License-Identifier: Apache-2.0
// How far a robot's arm reaches.
#pragma once

#include "common/model/robot_model.hpp"

namespace handsel {

/// Distance by which the far end of an object in the hand may lie beyond the frame of the tool,
/// e.g. the foot of a bottle that is held below its neck [m].
inline constexpr double kObjectBeyondTool = 0.25;

/// Of the arm that carries the tool link.
struct ArmReach {
  int shoulder{-1};  ///< link that the first axis of the arm moves; -1: no arm
  /// Distance from the origin of that link within which objects can be: the sum of the joint
  /// offsets to the tool and kObjectBeyondTool [m].
  double length{};
};

/// Returns the reach of the group "arm" to the tool link; without a tool link none.
ArmReach arm_reach(const RobotModel& robot);
/// Of the arm `arm` (may be null) whose hand is at `palm`: not counting axes that carry the arm.
ArmReach arm_reach(const RobotModel& robot, const Group* arm, int palm);

}  // namespace handsel
