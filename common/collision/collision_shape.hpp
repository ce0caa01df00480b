// SPDX-License-Identifier: Apache-2.0
// One shape prepared for collision tests: bounds for the quick rejection, FCL geometry for the
// exact answer.
#pragma once

#include <memory>

#include "common/collision/sphere_cover.hpp"

namespace handsel {

class CollisionShape {
 public:
  /// Prepares a shape. A mesh must have at least one triangle (else ConfigError).
  static std::shared_ptr<const CollisionShape> make(const Shape&);
  ~CollisionShape();

  const Shape& shape() const { return shape_; }  ///< as given to make()
  /// Bounding sphere, shape frame [m].
  const Vector3& sphere_center() const { return sphere_center_; }
  double sphere_radius() const { return sphere_radius_; }    ///< of the bounding sphere [m]
  const Vector3& box_center() const { return box_center_; }  ///< bounding box, shape frame [m]
  const Vector3& box_half() const { return box_half_; }      ///< its half extents [m]
  bool is_mesh() const { return std::holds_alternative<MeshPtr>(shape_); }  ///< a surface
  bool is_box() const { return std::holds_alternative<Box>(shape_); }       ///< a solid box

  /// Returns spheres that cover the shape, made at the first call.
  const std::shared_ptr<const SphereCover>& cover() const;

  struct Exact;                                   ///< FCL geometry
  const Exact& exact() const { return *exact_; }  ///< for touch() and gap()

 private:
  CollisionShape();
  Shape shape_;
  Vector3 sphere_center_{Vector3::Zero()}, box_center_{Vector3::Zero()}, box_half_{Vector3::Zero()};
  double sphere_radius_{};
  std::unique_ptr<Exact> exact_;
  mutable std::shared_ptr<const SphereCover> cover_;
};
using CollisionShapePtr = std::shared_ptr<const CollisionShape>;

/// Conservative: false means surely apart (spheres, then oriented boxes). `margin` [m] is kept
/// between them.
bool may_touch(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
               const Pose& T_world_b, double margin = 0.0);
/// Exact: do the solids touch? A mesh is its surface, except that a mesh inside a box, sphere,
/// cylinder or capsule touches it.
bool touch(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
           const Pose& T_world_b);
/// Exact distance, 0 when they touch [m]. The points nearest each other (world) are written when
/// given and they do not touch.
double gap(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
           const Pose& T_world_b, Vector3* on_a = nullptr, Vector3* on_b = nullptr);
/// A lower bound on the distance from the bounding spheres and boxes [m], >= 0.
double gap_bound(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
                 const Pose& T_world_b);

}  // namespace handsel
