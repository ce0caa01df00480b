// SPDX-License-Identifier: Apache-2.0
#include "common/collision/batch_chain.hpp"

#include <algorithm>
#include <cmath>

namespace handsel {
namespace {

/// Returns a rotation whose z axis is the given axis.
Eigen::Matrix3d along_z(const Vector3& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis).toRotationMatrix();
}

}  // namespace

void put_rows(const Pose& T, float out[12]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k) out[4 * i + k] = static_cast<float>(T.matrix()(i, k));
}

void BatchChain::fold(const RobotModel& robot, const std::vector<int>& axes, const Vector& q) {
  row_of_dof.assign(static_cast<std::size_t>(robot.dof()), -1);
  dof_of_row = axes;
  for (std::size_t i = 0; i < axes.size(); ++i)
    row_of_dof[static_cast<std::size_t>(axes[i])] = static_cast<int>(i);
  joints.clear();
  T_parent_joint.clear();
  slide.clear();
  body_of_link.assign(robot.links().size(), 0);
  T_body_link.assign(robot.links().size(), Pose::Identity());
  for (const Joint& joint : robot.joints()) {
    const auto parent = static_cast<std::size_t>(joint.parent),
               child = static_cast<std::size_t>(joint.child);
    Pose T = T_body_link[parent] * joint.T_parent_joint;
    const bool slides = joint.kind == JointKind::prismatic;
    const int row = joint.kind == JointKind::fixed || joint.dof < 0
                        ? -1
                        : row_of_dof[static_cast<std::size_t>(joint.dof)];
    if (row < 0) {
      const double value =
          (joint.dof >= 0 ? joint.mimic_factor * q[joint.dof] : 0.0) + joint.mimic_offset;
      if (joint.kind == JointKind::prismatic)
        T.translation() += T.linear() * (value * joint.axis);
      else if (joint.kind != JointKind::fixed)
        T.linear() = T.linear() * Eigen::AngleAxisd(value, joint.axis).toRotationMatrix();
      body_of_link[child] = body_of_link[parent];
      T_body_link[child] = T;
      continue;
    }
    const Eigen::Matrix3d turned = along_z(joint.axis);
    T.linear() = T.linear() * turned;
    detail::SimdJoint moving{};
    put_rows(T, moving.T);
    moving.parent = body_of_link[parent];
    moving.row = row;
    moving.factor = static_cast<float>(joint.mimic_factor);
    moving.offset = static_cast<float>(joint.mimic_offset);
    moving.slides = slides ? 1 : 0;
    joints.push_back(moving);
    T_parent_joint.push_back(T);
    const double farthest = std::max(std::abs(joint.lower), std::abs(joint.upper));
    slide.push_back(!slides ? 0.0 : std::isfinite(farthest) ? farthest : 1e3);
    body_of_link[child] = static_cast<int>(joints.size());
    T_body_link[child].linear() = turned.transpose();
    T_body_link[child].translation().setZero();
  }
}

}  // namespace handsel
