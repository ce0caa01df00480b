// SPDX-License-Identifier: Apache-2.0
#include "common/model/robot_model.hpp"

namespace handsel {
namespace {

void advance(const Joint& joint, const Vector& q, const Pose& T_root_parent, Pose& T_root_child) {
  T_root_child = T_root_parent * joint.T_parent_joint;
  if (joint.kind == JointKind::fixed) return;
  const double value =
      (joint.dof >= 0 ? joint.mimic_factor * q[joint.dof] : 0.0) + joint.mimic_offset;
  if (joint.kind == JointKind::prismatic)
    T_root_child.translation() += T_root_child.linear() * (value * joint.axis);
  else
    T_root_child.linear() =
        T_root_child.linear() * Eigen::AngleAxisd(value, joint.axis).toRotationMatrix();
}

}  // namespace

int RobotModel::link_index(const std::string& name) const {
  for (std::size_t i = 0; i < links_.size(); ++i)
    if (links_[i].name == name) return static_cast<int>(i);
  return -1;
}

const Group* RobotModel::group(const std::string& name) const {
  for (const auto& g : groups_)
    if (g.name == name) return &g;
  return nullptr;
}

const Group& RobotModel::require_group(const std::string& name) const {
  if (const Group* found = group(name)) return *found;
  std::string known;
  for (const auto& g : groups_) known += (known.empty() ? "" : ", ") + g.name;
  throw ConfigError("robot " + name_ + " has no group \"" + name + "\"; it has: " + known);
}

bool RobotModel::pair_disabled(int link_a, int link_b) const {
  return disabled_pairs_[static_cast<std::size_t>(link_a) * links_.size() +
                         static_cast<std::size_t>(link_b)];
}

void RobotModel::forward(const Vector& q, std::vector<Pose>& T_root_link) const {
  T_root_link.resize(links_.size());
  T_root_link[0].setIdentity();
  for (const auto& joint : joints_)
    advance(joint, q, T_root_link[joint.parent], T_root_link[joint.child]);
}

Pose RobotModel::link_pose(const Vector& q, int link) const {
  std::vector<Pose> poses;
  forward(q, poses);
  return poses.at(static_cast<std::size_t>(link));
}

Eigen::MatrixXd RobotModel::jacobian(const Vector& q, const Group& group) const {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(group.axes.size()));
  if (group.tip < 0) return J;
  std::vector<Pose> poses;
  forward(q, poses);
  const Vector3 tip = poses[group.tip].translation();
  for (int link = group.tip; links_[link].parent_joint >= 0;) {
    const Joint& joint = joints_[links_[link].parent_joint];
    for (std::size_t c = 0; c < group.axes.size() && joint.dof >= 0; ++c) {
      if (group.axes[c] != joint.dof) continue;
      const Pose& T = poses[link];
      const Vector3 axis = joint.mimic_factor * (T.linear() * joint.axis);
      const auto column = static_cast<Eigen::Index>(c);
      if (joint.kind == JointKind::prismatic) {
        J.block<3, 1>(0, column) += axis;
      } else {
        J.block<3, 1>(0, column) += axis.cross(tip - T.translation());
        J.block<3, 1>(3, column) += axis;
      }
    }
    link = joint.parent;
  }
  return J;
}

Vector RobotModel::with(const Vector& q, const Group& group, const Vector& group_q) {
  Vector out = q;
  for (std::size_t i = 0; i < group.axes.size(); ++i)
    out[group.axes[i]] = group_q[static_cast<Eigen::Index>(i)];
  return out;
}

Vector RobotModel::part(const Vector& q, const Group& group) {
  Vector out(static_cast<Eigen::Index>(group.axes.size()));
  for (std::size_t i = 0; i < group.axes.size(); ++i)
    out[static_cast<Eigen::Index>(i)] = q[group.axes[i]];
  return out;
}

}  // namespace handsel
