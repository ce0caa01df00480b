// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/active_arm.hpp"

#include <algorithm>

namespace handsel::manipulation_planner {

ActiveArm::ActiveArm(std::shared_ptr<const RobotModel> robot, const Snapshot& now)
    : robot_(std::move(robot)),
      now_(now),
      manipulators_(hands_of(*robot_)),
      group_(robot_->require_group("arm")),
      palm_(robot_->tool_link()) {
  if (const Group* fingers = robot_->group("hand")) fingers_ = *fingers;
}

void ActiveArm::select(std::size_t index) {
  index_ = index;
  group_ = *manipulators_[index].arm;
  finger_goal_.reset();
  fingers_ = manipulators_[index].fingers != nullptr ? *manipulators_[index].fingers : Group{};
  palm_ = manipulators_[index].palm;
}

HandState ActiveArm::hand_state() const {
  if (index_ == 0) return now_.execution()->hand;
  const auto& others = now_.execution()->other_hands;
  const auto other = std::find_if(others.begin(), others.end(), [this](const OtherHandState& o) {
    return o.group == fingers_.name;
  });
  return other == others.end() ? HandState::idle : other->hand;
}

bool ActiveArm::at_rest() const {
  return now_.set_point().size() == robot_->dof() &&
         now_.active().velocity(group_.axes).norm() < 1e-9;
}

Vector ActiveArm::configuration() const {
  Vector q = now_.scene().robot_position;
  for (const int axis : group_.axes) q[axis] = now_.set_point()[axis];
  for (const Manipulator& other : manipulators_)
    if (other.arm != nullptr)
      for (const int axis : other.arm->axes) q[axis] = now_.set_point()[axis];
  if (const Group* platform = robot_->group(kPlatformGroup))
    for (const int axis : platform->axes) q[axis] = now_.set_point()[axis];
  const bool opens = finger_goal_ && now_.execution() && hand_state() == HandState::moving;
  return opens ? RobotModel::with(q, fingers_, *finger_goal_) : q;
}

Vector ActiveArm::set_point_with(const Vector& arm_joints) const {
  return RobotModel::with(now_.set_point(), group_, arm_joints);
}

Vector3 ActiveArm::p_world_shoulder() const {
  const Axis& first = robot_->axes()[static_cast<std::size_t>(group_.axes.front())];
  const int link = robot_->joints()[static_cast<std::size_t>(first.joint)].child;
  return (now_.T_world_base() * robot_->link_pose(now_.set_point(), link)).translation();
}

std::optional<Vector> ActiveArm::reach(const Pose& T_world_tool) const {
  IkOptions options;
  options.restarts = 0;
  return robot_->inverse(group_, now_.T_world_base().inverse() * T_world_tool, now_.set_point(),
                         options);
}

Pose ActiveArm::T_grasp_standoff(const Grasp& grasp) const {
  const auto T_root_hand_at = [this](const Vector& joints) {
    return robot_->link_pose(set_point_with(joints), palm_);
  };
  return T_root_hand_at(grasp.arm_joints).inverse() * T_root_hand_at(grasp.approach_joints);
}

Vector3 ActiveArm::direction_back(const Grasp& grasp) const {
  const Vector3 back = T_grasp_standoff(grasp).translation();
  return back.norm() > 1e-6 ? back.normalized() : Vector3(-Vector3::UnitZ());
}

std::optional<Grasp> ActiveArm::grasp_at(const Pose& T_world_object, const Grasp& grasp) const {
  const Pose T_root_hand = now_.T_world_base().inverse() * T_world_object * grasp.T_object_hand;
  IkOptions options;
  options.restarts = 0;
  Grasp found = grasp;
  const auto at = robot_->inverse(group_, T_root_hand, set_point_with(grasp.arm_joints), options);
  if (!at) return std::nullopt;
  const auto before =
      robot_->inverse(group_, T_root_hand * T_grasp_standoff(grasp), set_point_with(*at), options);
  if (!before) return std::nullopt;
  found.arm_joints = *at;
  found.approach_joints = *before;
  return found;
}

}  // namespace handsel::manipulation_planner
