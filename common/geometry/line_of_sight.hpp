// SPDX-License-Identifier: Apache-2.0
// What hides what: straight lines of sight past capsules and boxes.
#pragma once

#include <cmath>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/geometry/segments.hpp"

namespace handsel {

struct SightCapsule {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the axis, world [m]
  double radius{};                                 ///< [m]
};

struct SightBox {
  Pose T_world_box{Pose::Identity()};  ///< centre
  Vector3 size{Vector3::Zero()};       ///< full extents [m]
};

/// Whether the point (world) is inside the capsule or on its surface.
inline bool contains(const SightCapsule& capsule, const Vector3& point) {
  Vector3 on_point, on_axis;
  return nearest_points(point, point, capsule.a, capsule.b, on_point, on_axis) <=
         capsule.radius * capsule.radius;
}

/// Whether the straight line from `eye` to `point` passes through the capsule. What the eye itself
/// is in hides nothing.
inline bool hides(const SightCapsule& capsule, const Vector3& eye, const Vector3& point) {
  Vector3 on_line, on_axis;
  return nearest_points(eye, point, capsule.a, capsule.b, on_line, on_axis) <
             capsule.radius * capsule.radius &&
         !contains(capsule, eye);
}

/// Whether the straight line from `eye` to `point` passes through the box. A box that the eye is in
/// hides nothing.
inline bool hides(const SightBox& box, const Vector3& eye, const Vector3& point) {
  const Vector3 from = box.T_world_box.inverse() * eye, to = box.T_world_box.inverse() * point,
                along = to - from;
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    const double half = box.size[i] / 2;
    if (std::abs(along[i]) < 1e-12) {
      if (std::abs(from[i]) >= half) return false;
      continue;
    }
    const double first = (-half - from[i]) / along[i], second = (half - from[i]) / along[i];
    enter = std::max(enter, std::min(first, second));
    leave = std::min(leave, std::max(first, second));
  }
  const bool eye_inside = (from.cwiseAbs() - box.size / 2).maxCoeff() < 0;
  return enter < leave && !eye_inside;
}

}  // namespace handsel
