// SPDX-License-Identifier: Apache-2.0
// Converts types and shapes to and from Bullet's (double precision).
#pragma once

#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "common/geometry/shape.hpp"

namespace handsel::sim {

/// Returns the vector as Bullet's type; units and axes are the same.
inline btVector3 to_bt(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
/// Returns Bullet's vector as Vector3; units and axes are the same.
inline Vector3 from_bt(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
/// Returns the quaternion as Bullet's type, which stores w last.
inline btQuaternion to_bt(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
/// Returns the pose as Bullet's type.
inline btTransform to_bt(const Pose& T) {
  return btTransform(to_bt(Eigen::Quaterniond(T.linear())), to_bt(Vector3(T.translation())));
}
/// Returns Bullet's transform as a pose, its rotation normalized.
inline Pose from_bt(const btTransform& T) {
  const btQuaternion q = T.getRotation();
  return make_pose(from_bt(T.getOrigin()), Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()));
}

/// Collision shapes with their owner: Bullet keeps plain pointers.
class ShapeStore {
 public:
  /// Returns a convex Bullet shape; a mesh becomes its convex hull, reduced to at most 42 vertices.
  btConvexShape* convex(const Shape&);
  /// Returns one shape for all of `parts`, placed by T_body_parent; nullptr without parts.
  btCollisionShape* combine(const std::vector<PlacedShape>& parts, const Pose& T_body_parent);

 private:
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
};

}  // namespace handsel::sim
