// SPDX-License-Identifier: Apache-2.0
#include "common/collision/enclosing.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace handsel {

CollisionShapePtr widened(const CollisionShapePtr& shape, double margin, Pose& T) {
  const auto grown = [&](const auto& solid) -> Shape {
    using S = std::decay_t<decltype(solid)>;
    if constexpr (std::is_same_v<S, Box>) {
      return Box{solid.size + Vector3::Constant(2 * margin)};
    } else if constexpr (std::is_same_v<S, Cylinder>) {
      return Cylinder{solid.radius + margin, solid.length + 2 * margin};
    } else if constexpr (std::is_same_v<S, Sphere>) {
      return Sphere{solid.radius + margin};
    } else if constexpr (std::is_same_v<S, Capsule>) {
      return Capsule{solid.radius + margin, solid.length};
    } else {
      Eigen::AlignedBox3d box;
      for (const Vector3& vertex : solid->vertices) box.extend(vertex);
      T = T * Eigen::Translation3d(box.center());
      return Box{box.sizes() + Vector3::Constant(2 * margin)};
    }
  };
  return CollisionShape::make(std::visit(grown, shape->shape()));
}

LinkCapsule enclosing_capsule(const std::vector<Vector3>& points) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Vector3 axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
  double low = 0, high = 0, radius = 0;
  for (const Vector3& p : points) radius = std::max(radius, (p - mean).cross(axis).norm());
  for (const Vector3& p : points) {
    const double across = (p - mean).cross(axis).norm(), x = (p - mean).dot(axis),
                 cap = std::sqrt(radius * radius - across * across);
    low = std::min(low, x + cap);
    high = std::max(high, x - cap);
  }
  LinkCapsule capsule;
  capsule.a = mean + low * axis;
  capsule.b = mean + high * axis;
  capsule.radius = radius;
  return capsule;
}

}  // namespace handsel
