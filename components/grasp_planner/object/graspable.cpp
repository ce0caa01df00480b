// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/object/graspable.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/base/errors.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kDeepInPart = 0.004;  // [m] depth at which a point counts as inside a part

// Returns the depth [m] of a point inside a shape, negative outside; -1 for meshes.
double depth(const Shape& shape, const Vector3& p) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return s->radius - p.norm();
  if (const auto* b = std::get_if<Box>(&shape)) return (0.5 * b->size - p.cwiseAbs()).minCoeff();
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return std::min(c->radius - p.head<2>().norm(), 0.5 * c->length - std::abs(p.z()));
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return c->radius -
           (p - Vector3(0, 0, std::clamp(p.z(), -0.5 * c->length, 0.5 * c->length))).norm();
  }
  return -1;
}

}  // namespace

Graspable::Graspable(const ObjectModel& object, double tip_radius, double step_fraction,
                     std::uint64_t seed)
    : name_(object.name), com_(object.com), friction_(object.friction), mass_(object.mass) {
  auto mesh = std::make_shared<TriangleMesh>(object.mesh);
  if (mesh->triangles.empty())
    throw ConfigError("object " + name_ + ": its mesh has no triangles; it needs a surface");
  findings_ = mend(*mesh);
  if (mesh->triangles.empty())
    throw ConfigError("object " + name_ +
                      ": no triangle of its mesh has an area; it needs a surface");
  triangles_ = TriangleTree(*mesh);
  const double largest = triangles_.box().sizes().maxCoeff();
  if (!(largest >= 0.005 && largest <= 2.0)) {
    std::ostringstream sentence;
    sentence << "object " << name_ << ": its mesh is " << largest
             << " m long; a hand can hold 0.005 to 2 m, so scale it";
    throw ConfigError(sentence.str());
  }
  for (const Vector3& v : mesh->vertices) radius_ = std::max(radius_, (v - com_).norm());
  SurfaceSettings settings;
  settings.step = step_fraction * tip_radius;
  settings.curvature_radius = tip_radius;
  settings.seed = seed;
  points_ = sample_surface(*mesh, settings);
  for (const ObjectPart& part : object.parts) {
    if (part.walls.empty()) filled_.push_back(part);
  }
  std::erase_if(points_, [&](const SurfacePoint& p) {
    return std::any_of(
        object.parts.begin(), object.parts.end(), [&p, tip_radius](const PlacedShape& part) {
          return depth(part.shape,
                       part.T_parent_shape.inverse() * (p.position + tip_radius * p.normal)) +
                     tip_radius >
                 kDeepInPart;
        });
  });
  if (points_.empty())
    throw ConfigError("object " + name_ +
                      ": no place of its mesh can be touched; its triangles are degenerate or all "
                      "inside its parts");
  for (const SurfacePoint& p : points_) centres_.push_back(p.position + tip_radius * p.normal);
  tip_centres_ = PointTree(centres_);
  mesh_ = mesh;
  shape_ = CollisionShape::make(mesh_);
}

bool Graspable::is_filled(const Vector3& position) const {
  return std::any_of(filled_.begin(), filled_.end(), [&position](const PlacedShape& part) {
    return depth(part.shape, part.T_parent_shape.inverse() * position) > kDeepInPart;
  });
}

double Graspable::curvature_near(const Vector3& position, const Vector3& normal) const {
  double best = std::numeric_limits<double>::infinity(), curvature = 0;
  for (const SurfacePoint& p : points_) {
    const double d = (p.position - position).squaredNorm() + (p.normal.dot(normal) > 0 ? 0 : 1);
    if (d < best) best = d, curvature = p.curvature;
  }
  return curvature;
}

}  // namespace handsel::grasp_planner
