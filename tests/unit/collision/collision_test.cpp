// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "common/base/errors.hpp"
#include "common/collision/collision_shape.hpp"
#include "common/collision/collision_world.hpp"

namespace handsel::collision_test {
namespace {

Pose at(double x, double y, double z) { return make_pose({x, y, z}); }

MeshPtr tetrahedron(double size) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST(ShapeDistance, spheres_along_an_axis) {
  const ShapeDistance d = shape_distance(Sphere{0.2}, at(0, 0, 0), Sphere{0.3}, at(1, 0, 0));
  EXPECT_FALSE(d.collide);
  EXPECT_NEAR(d.distance, 0.5, 1e-12);
}

TEST(ShapeDistance, touching_is_collision_with_distance_zero) {
  const ShapeDistance d =
      shape_distance(Box{{1, 1, 1}}, at(0, 0, 0), Box{{1, 1, 1}}, at(0.9, 0.2, 0.3));
  EXPECT_TRUE(d.collide);
  EXPECT_EQ(d.distance, 0.0);
}

TEST(ShapeDistance, box_corner_to_box_corner) {
  const ShapeDistance d = shape_distance(Box{{2, 2, 2}}, at(0, 0, 0), Box{{2, 2, 2}}, at(3, 3, 3));
  EXPECT_NEAR(d.distance, std::sqrt(3.0), 1e-9);
}

TEST(ShapeDistance, capsule_length_is_the_straight_part) {
  const ShapeDistance d = shape_distance(Capsule{0.1, 1.0}, at(0, 0, 0), Sphere{0.1}, at(0, 0, 1));
  EXPECT_NEAR(d.distance, 0.3, 1e-9);
}

TEST(ShapeDistance, cylinder_rim_to_sphere) {
  const ShapeDistance d =
      shape_distance(Cylinder{0.5, 1.0}, at(0, 0, 0), Sphere{0.1}, at(1.5, 0, 1.5));
  EXPECT_NEAR(d.distance, std::sqrt(2.0) - 0.1, 1e-7);
}

TEST(ShapeDistance, mesh_to_box) {
  const ShapeDistance d =
      shape_distance(tetrahedron(0.5), at(0, 0, 0), Box{{1, 1, 1}}, at(-1.25, 0, 0));
  EXPECT_FALSE(d.collide);
  EXPECT_NEAR(d.distance, 0.75, 1e-6);
}

TEST(ShapeDistance, mesh_wholly_inside_a_solid_collides) {
  EXPECT_TRUE(shape_distance(tetrahedron(0.1), at(0, 0, 0), Box{{1, 1, 1}}, at(0, 0, 0)).collide);
  EXPECT_TRUE(shape_distance(Sphere{1.0}, at(0, 0, 0), tetrahedron(0.1), at(0, 0, 0)).collide);
}

TEST(ShapeDistance, a_mesh_without_triangles_is_refused) {
  EXPECT_THROW(
      shape_distance(std::make_shared<TriangleMesh>(), at(0, 0, 0), Sphere{1.0}, at(0, 0, 0)),
      ConfigError);
}

TEST(SegmentDistance, crossing_parallel_and_degenerate) {
  EXPECT_NEAR(segment_distance({-1, 0, 0}, {1, 0, 0}, {0, -1, 0.5}, {0, 1, 0.5}), 0.5, 1e-12);
  EXPECT_NEAR(segment_distance({0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 1, 0}), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(segment_distance({0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {3, 1, 0}), 1.0, 1e-12);
  EXPECT_NEAR(segment_distance({0, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}), std::sqrt(3.0), 1e-12);
  Vector3 on_a, on_b;
  segment_distance({0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 3, 0}, &on_a, &on_b);
  EXPECT_NEAR((on_a - Vector3(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((on_b - Vector3(1, 1, 0)).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace handsel::collision_test
