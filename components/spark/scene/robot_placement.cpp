// SPDX-License-Identifier: Apache-2.0
#include "components/spark/scene/robot_placement.hpp"

#include <algorithm>

#include "common/model/manipulator.hpp"
#include "common/model/platform.hpp"

namespace handsel::spark {
namespace {

constexpr double kFingerLength = 0.05;  // converts the travel of a prismatic axis to an angle [m]

double arm_length(const RobotModel& robot) {
  double length = 0;
  for (int link = robot.tool_link(); link > 0;) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(
        robot.links()[static_cast<std::size_t>(link)].parent_joint)];
    if (joint.kind != JointKind::fixed || length == 0)
      length += joint.T_parent_joint.translation().norm();
    link = joint.parent;
  }
  return std::max(length, 0.5);
}

Coverage around(const Vector3& centre, double arm) {
  const double r = arm + 0.3;
  return {{centre.x() - r, centre.y() - r, 0.1}, {centre.x() + r, centre.y() + r, 1.9}};
}

}  // namespace

RobotPlacement::RobotPlacement(std::shared_ptr<const RobotModel> robot) : robot_(std::move(robot)) {
  arm_length_ = arm_length(*robot_);
  for (const Manipulator& hand : hands_of(*robot_)) {
    Hand out;
    if (!hands_.empty() && hand.fingers != nullptr) out.name = hand.fingers->name;
    out.palm = hand.palm;
    if (hand.fingers != nullptr) out.axes = hand.fingers->axes;
    hands_.push_back(std::move(out));
  }
  if (hands_.empty()) hands_.emplace_back();
}

void RobotPlacement::update(const RobotState& state) {
  known_ = true;
  position_ = state.position;
  hands_.front().payload = state.payload;
  for (std::size_t i = 1; i < hands_.size(); ++i)
    hands_[i].payload = i <= state.other_hands.size() ? state.other_hands[i - 1].payload : 0;
  T_world_base_ = state.T_world_base;
}

void RobotPlacement::locate() {
  if (!known_) return;
  robot_->forward(position_, links_);
  for (Hand& hand : hands_) {
    if (hand.palm >= 0)
      hand.T_world_palm = T_world_base_ * links_[static_cast<std::size_t>(hand.palm)];
    hand.fingers.resize(static_cast<Eigen::Index>(hand.axes.size()));
    for (std::size_t i = 0; i < hand.axes.size(); ++i)
      hand.fingers[static_cast<Eigen::Index>(i)] = angle_of(hand.axes[i]);
  }
}

double RobotPlacement::angle_of(int axis) const {
  const auto joint = static_cast<std::size_t>(robot_->axes()[static_cast<std::size_t>(axis)].joint);
  return robot_->joints()[joint].kind == JointKind::prismatic ? position_[axis] / kFingerLength
                                                              : position_[axis];
}

Coverage RobotPlacement::reach() const {
  const Pose T = known_ ? T_world_platform(*robot_, position_, T_world_base_) : T_world_base_;
  return around(T.translation(), arm_length_);
}

Coverage reach_of(const RobotModel& robot, const Vector3& base) {
  return around(base, arm_length(robot));
}

}  // namespace handsel::spark
