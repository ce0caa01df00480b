// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/collision/collision_shape.hpp"
#include "common/collision/collision_world.hpp"

namespace handsel {

double segment_distance(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1,
                        Vector3* on_a, Vector3* on_b) {
  const Vector3 da = a1 - a0, db = b1 - b0, r = a0 - b0;
  const double aa = da.squaredNorm(), bb = db.squaredNorm(), br = db.dot(r);
  double s = 0, t = 0;
  if (aa <= 1e-18 && bb > 1e-18) {
    t = std::clamp(br / bb, 0.0, 1.0);
  } else if (aa > 1e-18) {
    const double ar = da.dot(r);
    if (bb <= 1e-18) {
      s = std::clamp(-ar / aa, 0.0, 1.0);
    } else {
      const double ab = da.dot(db), det = aa * bb - ab * ab;
      if (det > 1e-14 * aa * bb) s = std::clamp((ab * br - ar * bb) / det, 0.0, 1.0);
      t = (ab * s + br) / bb;
      if (t < 0) {
        t = 0;
        s = std::clamp(-ar / aa, 0.0, 1.0);
      } else if (t > 1) {
        t = 1;
        s = std::clamp((ab - ar) / aa, 0.0, 1.0);
      }
    }
  }
  const Vector3 pa = a0 + s * da, pb = b0 + t * db;
  if (on_a) *on_a = pa;
  if (on_b) *on_b = pb;
  return (pa - pb).norm();
}

ShapeDistance shape_distance(const Shape& a, const Pose& T_world_a, const Shape& b,
                             const Pose& T_world_b) {
  const CollisionShapePtr first = CollisionShape::make(a), second = CollisionShape::make(b);
  if (touch(*first, T_world_a, *second, T_world_b)) return {true, 0.0};
  return {false, gap(*first, T_world_a, *second, T_world_b)};
}

int motion_states(const Vector& from, const Vector& to, double step) {
  const double length = from.size() == 0 ? 0.0 : (to - from).cwiseAbs().maxCoeff();
  return length <= 0 ? 1 : 1 + std::max(1, static_cast<int>(std::ceil(length / step - 1e-9)));
}

}  // namespace handsel
