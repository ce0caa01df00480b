// How far a robot's arm reaches.
#pragma once

#include "common/model/robot_model.hpp"

namespace handsel {

/// Of the arm that carries the tool link.
struct ArmReach {
  int shoulder{-1};  ///< link where its chain of moving joints begins; -1: no arm
  /// Sum of the joint offsets from the tool to the root or to the axis that carries the arm [m].
  double length{};
};

/// Returns the reach of the group "arm" to the tool link; without a tool link none.
ArmReach arm_reach(const RobotModel& robot);
/// Of the arm `arm` (may be null) whose hand is at `palm`: not counting axes that carry the arm.
ArmReach arm_reach(const RobotModel& robot, const Group* arm, int palm);

}  // namespace handsel
