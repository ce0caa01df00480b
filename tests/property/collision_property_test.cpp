// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <gtest/gtest.h>

#include "common/collision/collision_shape.hpp"
#include "common/collision/collision_world.hpp"
#include "common/collision/gjk.hpp"

namespace handsel::collision_property_test {
namespace {

constexpr unsigned kSeed = 20261;

Pose random_pose(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> place(-reach, reach);
  std::normal_distribution<double> turn;
  return make_pose({place(random), place(random), place(random)},
                   Eigen::Quaterniond(turn(random), turn(random), turn(random), turn(random)));
}

Shape random_shape(std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.05, 0.6);
  switch (random() % 4) {
    case 0:
      return Sphere{size(random)};
    case 1:
      return Box{{size(random), size(random), size(random)}};
    case 2:
      return Cylinder{0.5 * size(random), size(random)};
    default:
      return Capsule{0.5 * size(random), size(random)};
  }
}

bool contains(const Shape& shape, const Vector3& p, double grown) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return p.norm() <= s->radius + grown;
  if (const auto* b = std::get_if<Box>(&shape))
    return ((p.cwiseAbs() - 0.5 * b->size).array() <= grown).all();
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return std::hypot(p.x(), p.y()) <= c->radius + grown &&
           std::abs(p.z()) <= 0.5 * c->length + grown;
  const auto& c = std::get<Capsule>(shape);
  return (p - Vector3(0, 0, std::clamp(p.z(), -0.5 * c.length, 0.5 * c.length))).norm() <=
         c.radius + grown;
}

MeshPtr box_as_mesh(const Vector3& size) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (int i = 0; i < 8; ++i)
    mesh->vertices.emplace_back(
        Vector3((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, ((i >> 2) & 1) - 0.5).cwiseProduct(size));
  mesh->triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TEST(CollisionProperty, no_point_is_in_both_shapes_unless_they_touch) {
  std::mt19937 random(kSeed);
  RecordProperty("seed", kSeed);
  int touching = 0, shared = 0;
  for (int k = 0; k < 1500; ++k) {
    const Shape a = random_shape(random), b = random_shape(random);
    const Pose Ta = random_pose(random, 0.4), Tb = random_pose(random, 0.4);
    const ShapeDistance d = shape_distance(a, Ta, b, Tb);
    touching += d.collide;
    const CollisionShapePtr bounds = CollisionShape::make(a);
    std::uniform_real_distribution<double> unit(-1, 1);
    bool common = false;
    for (int i = 0; i < 400 && !common; ++i) {
      const Vector3 p = bounds->box_center() + bounds->box_half().cwiseProduct(Vector3(
                                                   unit(random), unit(random), unit(random)));
      common = contains(a, p, -1e-9) && contains(b, Tb.inverse() * (Ta * p), -1e-9);
    }
    shared += common;
    EXPECT_TRUE(!common || d.collide) << "case " << k << " seed " << kSeed;
    EXPECT_EQ(d.collide, d.distance == 0.0);
    EXPECT_LE(gap_bound(*bounds, Ta, *CollisionShape::make(b), Tb), d.distance + 1e-9);
  }
  EXPECT_GT(touching, 300);
  EXPECT_GT(shared, 200);
  EXPECT_LT(touching, 1300);
}

/// Returns whether a shape is inside a mesh without contact: a mesh is its surface, so it is free.
bool wholly_inside(const Shape& shape, const Pose& T, const Vector3& extents, const Pose& T_box) {
  const CollisionShapePtr bounds = CollisionShape::make(shape);
  const Vector3 center = T_box.inverse() * (T * bounds->box_center());
  return ((0.5 * extents - center.cwiseAbs()).array() > 0).all() &&
         bounds->sphere_radius() < 0.5 * extents.maxCoeff();
}

TEST(CollisionProperty, a_box_as_mesh_answers_like_the_box) {
  std::mt19937 random(kSeed + 1);
  std::uniform_real_distribution<double> size(0.05, 0.6);
  int touching = 0;
  for (int k = 0; k < 1500; ++k) {
    const Vector3 extents(size(random), size(random), size(random));
    const Shape other = random_shape(random);
    const Pose Ta = random_pose(random, 0.4), Tb = random_pose(random, 0.4);
    const double exact = convex_distance(convex_core(Box{extents}, Ta), convex_core(other, Tb));
    const ShapeDistance mesh = shape_distance(box_as_mesh(extents), Ta, other, Tb);
    touching += mesh.collide;
    if (exact > 1e-5) {
      EXPECT_FALSE(mesh.collide) << "case " << k;
      EXPECT_NEAR(mesh.distance, exact, 2e-5) << "case " << k;
    } else if (exact == 0.0 && !wholly_inside(other, Tb, extents, Ta)) {
      EXPECT_TRUE(mesh.collide || mesh.distance < 1e-5) << "case " << k;
    }
  }
  EXPECT_GT(touching, 200);
}

TEST(CollisionProperty, the_points_nearest_each_other_are_on_the_shapes_and_that_far_apart) {
  std::mt19937 random(kSeed + 3);
  std::uniform_real_distribution<double> size(0.05, 0.6);
  int apart = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector3 extents(size(random), size(random), size(random));
    const Shape a = k % 3 == 0 ? box_as_mesh(extents) : random_shape(random),
                b = k % 5 == 0 ? box_as_mesh(extents) : random_shape(random);
    const Pose Ta = random_pose(random, 0.6), Tb = random_pose(random, 0.6);
    Vector3 on_a, on_b;
    const double d = gap(*CollisionShape::make(a), Ta, *CollisionShape::make(b), Tb, &on_a, &on_b);
    if (d < 1e-4) continue;
    ++apart;
    const auto solid = [&](const Shape& shape) {
      return std::holds_alternative<MeshPtr>(shape) ? Shape(Box{extents}) : shape;
    };
    EXPECT_NEAR((on_a - on_b).norm(), d, 2e-5) << "case " << k;
    EXPECT_TRUE(contains(solid(a), Ta.inverse() * on_a, 2e-6)) << "case " << k;
    EXPECT_TRUE(contains(solid(b), Tb.inverse() * on_b, 2e-6)) << "case " << k;
  }
  EXPECT_GT(apart, 500);
}

TEST(CollisionProperty, distance_is_symmetric_and_keeps_under_rigid_motion) {
  std::mt19937 random(kSeed + 2);
  for (int k = 0; k < 1000; ++k) {
    const Shape a = random_shape(random), b = random_shape(random);
    const Pose Ta = random_pose(random, 0.8), Tb = random_pose(random, 0.8),
               T = random_pose(random, 3);
    const double d = shape_distance(a, Ta, b, Tb).distance;
    EXPECT_NEAR(shape_distance(b, Tb, a, Ta).distance, d, 1e-8);
    EXPECT_NEAR(shape_distance(a, T * Ta, b, T * Tb).distance, d, 1e-8);
  }
}

}  // namespace
}  // namespace handsel::collision_property_test
