// SPDX-License-Identifier: Apache-2.0
#include "common/collision/collision_shape.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <utility>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "common/base/errors.hpp"
#include "common/collision/gjk.hpp"

namespace handsel {
namespace {

using Bvh = fcl::BVHModel<fcl::OBBRSSd>;

std::unique_ptr<fcl::CollisionGeometryd> bvh(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw ConfigError("a collision mesh has no triangles; it needs at least one");
  auto model = std::make_unique<Bvh>();
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  model->addSubModel(mesh.vertices, triangles);
  model->endModel();
  model->computeLocalAABB();
  return model;
}

TriangleMesh box_mesh(const Vector3& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(),
                               (i & 4 ? 1 : -1) * half.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Computes Ritter's bounding sphere of points.
void bounding_sphere(const std::vector<Vector3>& points, Vector3& center, double& radius) {
  const auto farthest = [&](const Vector3& from) {
    return *std::max_element(points.begin(), points.end(), [&](const Vector3& a, const Vector3& b) {
      return (a - from).squaredNorm() < (b - from).squaredNorm();
    });
  };
  const Vector3 a = farthest(points.front()), b = farthest(a);
  center = 0.5 * (a + b);
  radius = 0.5 * (b - a).norm();
  for (const Vector3& p : points) {
    const double d = (p - center).norm();
    if (d <= radius) continue;
    const double grown = 0.5 * (radius + d);
    center += (p - center) * ((grown - radius) / d);
    radius = grown;
  }
  radius += 1e-9;
}

}  // namespace

/// Exact shape. A box is stored as 12 triangles: FCL tests a mesh against those faster than against
/// its box primitive.
struct CollisionShape::Exact {
  std::unique_ptr<fcl::CollisionGeometryd> geometry;
};

CollisionShape::CollisionShape() = default;
CollisionShape::~CollisionShape() = default;

namespace {

bool same(const Shape& a, const Shape& b) {
  if (a.index() != b.index()) return false;
  if (const auto* sphere = std::get_if<Sphere>(&a))
    return sphere->radius == std::get<Sphere>(b).radius;
  if (const auto* box = std::get_if<Box>(&a)) return box->size == std::get<Box>(b).size;
  if (const auto* round = std::get_if<Cylinder>(&a))
    return round->radius == std::get<Cylinder>(b).radius &&
           round->length == std::get<Cylinder>(b).length;
  if (const auto* capsule = std::get_if<Capsule>(&a))
    return capsule->radius == std::get<Capsule>(b).radius &&
           capsule->length == std::get<Capsule>(b).length;
  const TriangleMesh &x = *std::get<MeshPtr>(a), &y = *std::get<MeshPtr>(b);
  return x.triangles == y.triangles && x.vertices == y.vertices;
}

/// Returns a cached cover of equal shapes: many worlds of one process contain the same robot.
std::shared_ptr<const SphereCover> remembered_cover(const Shape& shape) {
  constexpr std::size_t kMaxCovers = 200;
  static std::mutex mutex;
  static std::deque<std::pair<Shape, std::shared_ptr<const SphereCover>>> made;
  const std::lock_guard lock(mutex);
  for (const auto& [known, cover] : made)
    if (same(known, shape)) return cover;
  made.emplace_back(shape, std::make_shared<const SphereCover>(cover_shape(shape)));
  if (made.size() > kMaxCovers) made.pop_front();
  return made.back().second;
}

}  // namespace

const std::shared_ptr<const SphereCover>& CollisionShape::cover() const {
  if (!cover_) cover_ = remembered_cover(shape_);
  return cover_;
}

CollisionShapePtr CollisionShape::make(const Shape& shape) {
  std::shared_ptr<CollisionShape> out(new CollisionShape);
  out->shape_ = shape;
  out->exact_ = std::make_unique<Exact>();
  auto& geometry = out->exact_->geometry;
  if (const auto* mesh = std::get_if<MeshPtr>(&shape)) {
    geometry = bvh(**mesh);
    bounding_sphere((*mesh)->vertices, out->sphere_center_, out->sphere_radius_);
    const ConvexCore bounds = convex_core(shape, Pose::Identity());
    out->box_center_ = bounds.T_world_core.translation();
    out->box_half_ = bounds.half;
    if (out->box_half_.norm() < out->sphere_radius_) {
      out->sphere_center_ = out->box_center_;
      out->sphere_radius_ = out->box_half_.norm();
    }
    return out;
  }
  const ConvexCore core = convex_core(shape, Pose::Identity());
  out->box_half_ = core.half + Vector3::Constant(core.margin);
  out->sphere_radius_ = core.half.norm() + core.margin;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    out->sphere_radius_ = std::hypot(cylinder->radius, 0.5 * cylinder->length);
    geometry = std::make_unique<fcl::Cylinderd>(cylinder->radius, cylinder->length);
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    geometry = bvh(box_mesh(0.5 * box->size));
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    geometry = std::make_unique<fcl::Sphered>(sphere->radius);
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    geometry = std::make_unique<fcl::Capsuled>(capsule->radius, capsule->length);
  }
  return out;
}

namespace {

double point_box_distance(const Vector3& p_local, const Vector3& half) {
  return (p_local.cwiseAbs() - half).cwiseMax(0.0).norm();
}

/// Returns the max gap over the 15 separating axes of two oriented boxes [m].
double box_separation(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
                      const Pose& T_world_b) {
  const Eigen::Matrix3d R = T_world_a.linear().transpose() * T_world_b.linear();
  const Vector3 t =
      T_world_a.linear().transpose() * (T_world_b * b.box_center() - T_world_a * a.box_center());
  const Eigen::Matrix3d A = R.cwiseAbs();
  const Vector3 &ha = a.box_half(), &hb = b.box_half();
  double best = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) best = std::max(best, std::abs(t[i]) - ha[i] - A.row(i).dot(hb));
  for (int j = 0; j < 3; ++j)
    best = std::max(best, std::abs(t.dot(R.col(j))) - A.col(j).dot(ha) - hb[j]);
  if (best > 0) return best;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double length = std::sqrt(std::max(0.0, 1.0 - R(i, j) * R(i, j)));
      if (length < 1e-6) continue;
      const double distance = std::abs(t[i2] * R(i1, j) - t[i1] * R(i2, j));
      const double reach =
          ha[i1] * A(i2, j) + ha[i2] * A(i1, j) + hb[j1] * A(i, j2) + hb[j2] * A(i, j1);
      best = std::max(best, (distance - reach) / length);
    }
  return best;
}

bool inside(const Vector3& p_world, const CollisionShape& solid, const Pose& T_world_solid) {
  ConvexCore point;
  point.T_world_core.translation() = p_world;
  return convex_touch(point, convex_core(solid.shape(), T_world_solid));
}

const Vector3& any_vertex(const CollisionShape& mesh) {
  return std::get<MeshPtr>(mesh.shape())->vertices.front();
}

}  // namespace

bool may_touch(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
               const Pose& T_world_b, double margin) {
  const Vector3 ca = T_world_a * a.sphere_center(), cb = T_world_b * b.sphere_center();
  const double reach = a.sphere_radius() + b.sphere_radius() + margin;
  if ((ca - cb).squaredNorm() > reach * reach) return false;
  const Vector3 a_in_b =
      T_world_b.linear().transpose() * (ca - T_world_b.translation()) - b.box_center();
  if (point_box_distance(a_in_b, b.box_half()) > a.sphere_radius() + margin) return false;
  const Vector3 b_in_a =
      T_world_a.linear().transpose() * (cb - T_world_a.translation()) - a.box_center();
  if (point_box_distance(b_in_a, a.box_half()) > b.sphere_radius() + margin) return false;
  return box_separation(a, T_world_a, b, T_world_b) <= margin;
}

double gap_bound(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
                 const Pose& T_world_b) {
  const Vector3 ca = T_world_a * a.sphere_center(), cb = T_world_b * b.sphere_center();
  const Vector3 a_in_b =
      T_world_b.linear().transpose() * (ca - T_world_b.translation()) - b.box_center();
  const Vector3 b_in_a =
      T_world_a.linear().transpose() * (cb - T_world_a.translation()) - a.box_center();
  return std::max({0.0, (ca - cb).norm() - a.sphere_radius() - b.sphere_radius(),
                   point_box_distance(a_in_b, b.box_half()) - a.sphere_radius(),
                   point_box_distance(b_in_a, a.box_half()) - b.sphere_radius(),
                   box_separation(a, T_world_a, b, T_world_b)});
}

bool touch(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
           const Pose& T_world_b) {
  if (!may_touch(a, T_world_a, b, T_world_b)) return false;
  if (!a.is_mesh() && !b.is_mesh())
    return convex_touch(convex_core(a.shape(), T_world_a), convex_core(b.shape(), T_world_b));
  static const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  if (fcl::collide(a.exact().geometry.get(), T_world_a, b.exact().geometry.get(), T_world_b,
                   request, result) > 0)
    return true;
  if (a.is_mesh() && !b.is_mesh()) return inside(T_world_a * any_vertex(a), b, T_world_b);
  if (b.is_mesh() && !a.is_mesh()) return inside(T_world_b * any_vertex(b), a, T_world_a);
  return false;
}

namespace {
struct ShapeAtPose {
  const CollisionShape& shape;
  const Pose& T_world_shape;
};
}  // namespace

/// Returns the shape itself, or the triangle of a mesh.
static ConvexCore nearest_core(const ShapeAtPose& placed, int triangle) {
  const CollisionShape& shape = placed.shape;
  if (!shape.is_mesh()) return convex_core(shape.shape(), placed.T_world_shape);
  const TriangleMesh& mesh = *std::get<MeshPtr>(shape.shape());
  ConvexCore core;
  core.kind = ConvexCore::Kind::triangle;
  core.T_world_core = placed.T_world_shape;
  const auto& corners = mesh.triangles[static_cast<std::size_t>(triangle)];
  for (std::size_t i = 0; i < 3; ++i)
    core.corners[i] = mesh.vertices[static_cast<std::size_t>(corners[i])];
  return core;
}

/// Computes the nearest points. For meshes against other shapes FCL's points and triangles are
/// wrong: there all triangles are searched.
static void nearest_points(const ShapeAtPose& a, const ShapeAtPose& b,
                           const fcl::DistanceResultd& result, Vector3* on_a, Vector3* on_b) {
  if (a.shape.is_mesh() && b.shape.is_mesh()) {
    convex_distance(nearest_core(a, static_cast<int>(result.b1)),
                    nearest_core(b, static_cast<int>(result.b2)), on_a, on_b);
    return;
  }
  const CollisionShape& mesh = a.shape.is_mesh() ? a.shape : b.shape;
  const int triangles = static_cast<int>(std::get<MeshPtr>(mesh.shape())->triangles.size());
  double min_distance = std::numeric_limits<double>::infinity();
  for (int i = 0; i < triangles; ++i) {
    Vector3 point_a, point_b;
    const double distance =
        convex_distance(nearest_core(a, i), nearest_core(b, i), &point_a, &point_b);
    if (distance >= min_distance || distance <= 0) continue;
    min_distance = distance;
    if (on_a != nullptr) *on_a = point_a;
    if (on_b != nullptr) *on_b = point_b;
  }
}

double gap(const CollisionShape& a, const Pose& T_world_a, const CollisionShape& b,
           const Pose& T_world_b, Vector3* on_a, Vector3* on_b) {
  if (!a.is_mesh() && !b.is_mesh())
    return convex_distance(convex_core(a.shape(), T_world_a), convex_core(b.shape(), T_world_b),
                           on_a, on_b);
  if (touch(a, T_world_a, b, T_world_b)) return 0.0;
  fcl::DistanceRequestd request;
  request.distance_tolerance = 1e-6;
  fcl::DistanceResultd result;
  fcl::distance(a.exact().geometry.get(), T_world_a, b.exact().geometry.get(), T_world_b, request,
                result);
  if (on_a != nullptr || on_b != nullptr)
    nearest_points({a, T_world_a}, {b, T_world_b}, result, on_a, on_b);
  return std::max(0.0, result.min_distance);
}

}  // namespace handsel
