// SPDX-License-Identifier: Apache-2.0
// Vectors and poses as descriptions write them.
#pragma once

#include "common/config/schema/robot.pb.h"
#include "common/geometry/pose.hpp"

namespace handsel {

/// Returns the three numbers as they are, in whatever unit they are written.
inline Vector3 to_vector(const config::Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Roll, pitch, yaw about fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll).
inline Pose to_pose(const config::PoseRpy& pose) {
  const Vector3 rpy = to_vector(pose.rpy());
  return make_pose(to_vector(pose.xyz()), Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
                                              Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
                                              Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()));
}

}  // namespace handsel
