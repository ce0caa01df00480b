#include "components/grasp_planner/graspable.hpp"

#include <algorithm>
#include <sstream>

#include "common/base/errors.hpp"

namespace handsel::grasp_planner {

Graspable::Graspable(const ObjectModel& object, double tip_radius, double step_share, std::uint64_t seed)
    : name_(object.name), com_(object.com), friction_(object.friction) {
  auto mesh = std::make_shared<TriangleMesh>(object.mesh);
  if (mesh->triangles.empty()) throw ConfigError("object " + name_ + ": its mesh has no triangles; it needs a surface");
  findings_ = orient(*mesh);
  triangles_ = TriangleTree(*mesh);
  const double largest = triangles_.box().sizes().maxCoeff();
  if (!(largest >= 0.005 && largest <= 2.0)) {
    std::ostringstream sentence;
    sentence << "object " << name_ << ": its mesh is " << largest << " m long; a hand can hold 0.005 to 2 m, so scale it";
    throw ConfigError(sentence.str());
  }
  for (const Vector3& v : mesh->vertices) radius_ = std::max(radius_, (v - com_).norm());
  SurfaceSettings settings;
  settings.step = step_share * tip_radius;
  settings.curvature_radius = tip_radius;
  settings.seed = seed;
  points_ = sample_surface(*mesh, settings);
  if (points_.empty()) throw ConfigError("object " + name_ + ": its mesh has no area; all its triangles are degenerate");
  for (const SurfacePoint& p : points_) centres_.push_back(p.position + tip_radius * p.normal);
  tip_centres_ = PointTree(centres_);
  mesh_ = mesh;
  shape_ = CollisionShape::make(mesh_);
}

}  // namespace handsel::grasp_planner
