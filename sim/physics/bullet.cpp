// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/bullet.hpp"

#include <BulletCollision/CollisionShapes/btShapeHull.h>

#include <algorithm>

namespace handsel::sim {

namespace {

constexpr double kMargin = 0.0005;  // collision margin of a shape [m]

std::unique_ptr<btConvexShape> hull(const TriangleMesh& mesh) {
  btConvexHullShape full;
  full.setMargin(0);
  std::vector<Vector3> vertices = mesh.vertices;  // many files repeat a vertex for each triangle
  const auto before = [](const Vector3& a, const Vector3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(vertices.begin(), vertices.end(), before);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const Vector3& v : vertices) full.addPoint(to_bt(v), false);
  full.recalcLocalAabb();
  auto small = std::make_unique<btConvexHullShape>();
  if (vertices.size() > 42) {
    btShapeHull reduced(&full);
    reduced.buildHull(0);
    for (int i = 0; i < reduced.numVertices(); ++i)
      small->addPoint(reduced.getVertexPointer()[i], false);
  } else {
    for (const Vector3& v : vertices) small->addPoint(to_bt(v), false);
  }
  small->recalcLocalAabb();
  small->setMargin(kMargin);
  return small;
}

struct Make {
  std::unique_ptr<btConvexShape> operator()(const Sphere& s) const {
    return std::make_unique<btSphereShape>(s.radius);
  }
  std::unique_ptr<btConvexShape> operator()(const Box& b) const {
    auto shape = std::make_unique<btBoxShape>(to_bt(Vector3(b.size / 2)));
    shape->setMargin(kMargin);
    return shape;
  }
  std::unique_ptr<btConvexShape> operator()(const Cylinder& c) const {
    auto shape = std::make_unique<btCylinderShapeZ>(btVector3(c.radius, c.radius, c.length / 2));
    shape->setMargin(kMargin);
    return shape;
  }
  std::unique_ptr<btConvexShape> operator()(const Capsule& c) const {
    return std::make_unique<btCapsuleShapeZ>(c.radius, c.length);
  }
  std::unique_ptr<btConvexShape> operator()(const MeshPtr& m) const { return hull(*m); }
};

}  // namespace

btConvexShape* ShapeStore::convex(const Shape& shape) {
  std::unique_ptr<btConvexShape> made = std::visit(Make{}, shape);
  btConvexShape* raw = made.get();
  shapes_.push_back(std::move(made));
  return raw;
}

btCollisionShape* ShapeStore::combine(const std::vector<PlacedShape>& parts,
                                      const Pose& T_body_parent) {
  if (parts.empty()) return nullptr;
  auto compound = std::make_unique<btCompoundShape>(parts.size() > 4);
  for (const PlacedShape& part : parts)
    compound->addChildShape(to_bt(Pose(T_body_parent * part.T_parent_shape)), convex(part.shape));
  compound->setMargin(kMargin);
  btCollisionShape* raw = compound.get();
  shapes_.push_back(std::move(compound));
  return raw;
}

}  // namespace handsel::sim
