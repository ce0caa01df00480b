// SPDX-License-Identifier: Apache-2.0
// Rigid transforms. T_a_b maps coordinates in frame b to frame a. SI units, right-handed, z up
// (REP-103).
#pragma once

#include <Eigen/Geometry>

namespace handsel {

using Vector3 = Eigen::Vector3d;
using Pose = Eigen::Isometry3d;
using Vector = Eigen::VectorXd;

/// Returns the pose with origin p [m] and rotation q, which is normalized first.
inline Pose make_pose(const Vector3& p,
                      const Eigen::Quaterniond& q = Eigen::Quaterniond::Identity()) {
  Pose T = Pose::Identity();
  T.translation() = p;
  T.linear() = q.normalized().toRotationMatrix();
  return T;
}

/// Force and torque at a frame's origin, in that frame's axes.
struct Wrench {
  Vector3 force{Vector3::Zero()};   ///< [N]
  Vector3 torque{Vector3::Zero()};  ///< [Nm]
};

}  // namespace handsel
