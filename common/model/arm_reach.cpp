// SPDX-License-Identifier: Apache-2.0
#include "common/model/arm_reach.hpp"

namespace handsel {

ArmReach arm_reach(const RobotModel& robot) {
  return arm_reach(robot, robot.group("arm"), robot.tool_link());
}

ArmReach arm_reach(const RobotModel& robot, const Group* arm, int palm) {
  const int first = arm == nullptr || arm->axes.empty()
                        ? -1
                        : robot.axes()[static_cast<std::size_t>(arm->axes.front())].joint;
  ArmReach reach;
  double length = kObjectBeyondTool;  // up to the frame of `link` [m]
  for (int link = palm; link > 0;) {
    const int up = robot.links()[static_cast<std::size_t>(link)].parent_joint;
    const Joint& joint = robot.joints()[static_cast<std::size_t>(up)];
    if (joint.kind != JointKind::fixed) reach = {link, length};
    if (up == first) break;
    length += joint.T_parent_joint.translation().norm();
    link = joint.parent;
  }
  return reach;
}

}  // namespace handsel
