// Conversions and shapes between our types and Bullet's (double precision).
#pragma once

#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "common/geometry/shape.hpp"

namespace handsel::sim {

inline btVector3 to_bt(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
inline Vector3 from_bt(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline btQuaternion to_bt(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline btTransform to_bt(const Pose& T) { return btTransform(to_bt(Eigen::Quaterniond(T.linear())), to_bt(Vector3(T.translation()))); }
inline Pose from_bt(const btTransform& T) {
  const btQuaternion q = T.getRotation();
  return make_pose(from_bt(T.getOrigin()), Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()));
}

/// Collision shapes with their owner: Bullet keeps plain pointers.
class ShapeStore {
 public:
  /// A convex Bullet shape for ours; a mesh becomes its convex hull, reduced to at most 42 vertices.
  btConvexShape* convex(const Shape&);
  /// One shape for all of `parts`, placed by T_body_parent; nullptr if there are none.
  btCollisionShape* combine(const std::vector<PlacedShape>& parts, const Pose& T_body_parent);

 private:
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
};

}  // namespace handsel::sim
