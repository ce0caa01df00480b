#include "common/model/arm_reach.hpp"

namespace handsel {

ArmReach arm_reach(const RobotModel& robot) {
  ArmReach reach;
  for (int link = robot.tool_link(); link > 0;) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(robot.links()[static_cast<std::size_t>(link)].parent_joint)];
    if (joint.kind != JointKind::fixed) reach.shoulder = link;
    reach.length += joint.T_parent_joint.translation().norm();
    link = joint.parent;
  }
  return reach;
}

}  // namespace handsel
