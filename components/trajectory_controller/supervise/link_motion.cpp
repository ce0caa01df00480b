// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/link_motion.hpp"

namespace handsel::trajectory_controller {

void link_twists(const RobotModel& robot, const Vector& velocity,
                 const std::vector<Pose>& T_root_link, std::vector<LinkTwist>& out) {
  out.resize(robot.links().size());
  out[0] = {};
  for (const Joint& joint : robot.joints()) {
    const LinkTwist& parent = out[static_cast<std::size_t>(joint.parent)];
    LinkTwist& child = out[static_cast<std::size_t>(joint.child)];
    const Pose& T = T_root_link[static_cast<std::size_t>(joint.child)];
    child.angular = parent.angular;
    child.linear =
        parent.linear +
        parent.angular.cross(T.translation() -
                             T_root_link[static_cast<std::size_t>(joint.parent)].translation());
    if (joint.kind == JointKind::fixed || joint.dof < 0) continue;
    const Vector3 motion = joint.mimic_factor * velocity[joint.dof] * (T.linear() * joint.axis);
    (joint.kind == JointKind::prismatic ? child.linear : child.angular) += motion;
  }
}

}  // namespace handsel::trajectory_controller
