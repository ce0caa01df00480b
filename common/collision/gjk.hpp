// SPDX-License-Identifier: Apache-2.0
// Distance of convex shapes: GJK on their cores (point, segment, triangle, box, cylinder), the
// rounding radius taken off afterwards. Double precision, closes to 1e-9 m; never the signed
// distance.
#pragma once

#include <array>

#include "common/geometry/shape.hpp"

namespace handsel {

/// A convex core and what is rolled around it.
struct ConvexCore {
  enum class Kind { point, segment, triangle, box, cylinder } kind{Kind::point};
  /// Box: half extents; segment, cylinder: half.z() half length; cylinder: half.x() radius [m].
  Vector3 half{Vector3::Zero()};
  double margin{};                      ///< radius rolled around the core [m]
  std::array<Vector3, 3> corners;       ///< of a triangle only [m]
  Pose T_world_core{Pose::Identity()};  ///< frame of the core
};

/// Core of a sphere, box, cylinder or capsule. A mesh has none: its bounding box is returned, which
/// is not what you want.
ConvexCore convex_core(const Shape&, const Pose& T_world_shape);

/// Distance of the two shapes, 0 when they touch [m]. The points nearest each other (world) are
/// written when given and they do not touch.
double convex_distance(const ConvexCore& a, const ConvexCore& b, Vector3* on_a = nullptr,
                       Vector3* on_b = nullptr);
/// Whether they touch; stops as soon as a separating plane is found.
bool convex_touch(const ConvexCore& a, const ConvexCore& b);

}  // namespace handsel
