// SPDX-License-Identifier: Apache-2.0
#include "common/model/object_surface.hpp"

#include <algorithm>
#include <limits>

namespace handsel {

namespace {

double box_distance(const Vector3& p, const Vector3& half) {
  const Vector3 d = p.cwiseAbs() - half;
  return d.cwiseMax(0).norm() + std::min(d.maxCoeff(), 0.0);
}

struct Distance {
  Vector3 p;
  double operator()(const Sphere& s) const { return p.norm() - s.radius; }
  double operator()(const Box& b) const { return box_distance(p, b.size / 2); }
  double operator()(const Cylinder& c) const {
    const Eigen::Vector2d d(std::hypot(p.x(), p.y()) - c.radius, std::abs(p.z()) - c.length / 2);
    return d.cwiseMax(0).norm() + std::min(d.maxCoeff(), 0.0);
  }
  double operator()(const Capsule& c) const {
    return (p - Vector3(0, 0, std::clamp(p.z(), -c.length / 2, c.length / 2))).norm() - c.radius;
  }
  double operator()(const MeshPtr& m) const {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vector3& v : m->vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    return box_distance(p - (low + high) / 2, (high - low) / 2);
  }
};

}  // namespace

double surface_distance(const ObjectModel& model, const Vector3& p_object) {
  double least = std::numeric_limits<double>::infinity();
  for (const PlacedShape& part : model.parts) {
    least =
        std::min(least, std::visit(Distance{part.T_parent_shape.inverse() * p_object}, part.shape));
  }
  return least;
}

}  // namespace handsel
