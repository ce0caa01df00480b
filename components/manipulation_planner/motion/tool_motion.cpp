// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/tool_motion.hpp"

#include <cmath>

#include "common/model/srs_arm.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

TipNode tip_node(const Parts& parts, const Pose& T_world_tool, const Vector& q) {
  TipNode node;
  node.T_world_tip = T_world_tool;
  const ik::Chain chain(parts.arm.robot(), parts.arm.group(), q);
  const std::optional<ik::SrsArm> srs = ik::SrsArm::recognise(chain);
  node.has_elbow = srs.has_value();
  if (srs) node.elbow = srs->elbow_angle(RobotModel::part(q, parts.arm.group()));
  return node;
}

std::optional<TrajectoryRequest> tool_request(Parts& parts, const MotionSpec& motion) {
  const RobotModel& robot = parts.arm.robot();
  Vector start = parts.arm.configuration();
  const Group& fingers = parts.arm.fingers();
  if (motion.fingers)
    start = RobotModel::with(start, fingers, RobotModel::part(parts.now.set_point(), fingers));
  const Vector goal = RobotModel::with(start, parts.arm.group(), motion.goals.front());
  const Pose T_world_goal = parts.now.T_world_base() * robot.link_pose(goal, parts.arm.palm());
  TipNode end = tip_node(parts, T_world_goal, goal);
  if (!end.has_elbow) return std::nullopt;
  TrajectoryRequest request =
      trajectory_request(parts, parts.clients.trajectory, {}, start, motion);
  if (const std::optional<TiltBound> bound = tilt_bound(parts, motion)) {
    request.upright = true;
    request.upright_axis = bound->axis_tool;
    request.max_tilt = bound->max_tilt;
  }
  if (motion.fingers) {
    request.also.assign(fingers.axes.begin(), fingers.axes.end());
    const Pose T_world_start = parts.now.T_world_base() * robot.link_pose(start, parts.arm.palm());
    const double part = 1.0 - parts.settings.closing_part;
    Pose T_world_between = T_world_start;
    T_world_between.translation() +=
        part * (T_world_goal.translation() - T_world_start.translation());
    T_world_between.linear() = Eigen::Quaterniond(T_world_start.linear())
                                   .slerp(part, Eigen::Quaterniond(T_world_goal.linear()))
                                   .toRotationMatrix();
    TipNode between = tip_node(parts, T_world_between, start);
    between.elbow += part * std::remainder(end.elbow - between.elbow, 2 * M_PI);
    between.also = RobotModel::part(start, fingers);
    request.poses.push_back(between);
    end.also = *motion.fingers;
  }
  request.poses.push_back(end);
  return request;
}

}  // namespace handsel::manipulation_planner
