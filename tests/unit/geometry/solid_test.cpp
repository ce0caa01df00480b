// SPDX-License-Identifier: Apache-2.0
// Meshes as cells and as convex parts, compared with shapes whose volumes are known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/solid/convex_hull.hpp"
#include "common/geometry/solid/convex_parts.hpp"

namespace handsel::solid_test {
namespace {

/// A surface of revolution about z through points (radius, height), closed where the radius is 0.
TriangleMesh turned(const std::vector<std::pair<double, double>>& outline, int sides) {
  TriangleMesh out;
  for (const auto& [r, z] : outline)
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * std::numbers::pi * k / sides;
      out.vertices.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
  for (int row = 0; row + 1 < static_cast<int>(outline.size()); ++row)
    for (int k = 0; k < sides; ++k) {
      const int a = row * sides + k, b = row * sides + (k + 1) % sides;
      if (outline[static_cast<std::size_t>(row)].first > 0)
        out.triangles.push_back({a, b, a + sides});
      if (outline[static_cast<std::size_t>(row) + 1].first > 0)
        out.triangles.push_back({b, b + sides, a + sides});
    }
  return out;
}

/// A cup: 80 mm wide, 100 mm tall, its wall and floor 6 mm thick.
TriangleMesh cup() {
  return turned({{0, 0}, {0.04, 0}, {0.04, 0.1}, {0.034, 0.1}, {0.034, 0.006}, {0, 0.006}}, 64);
}

double volume_of_parts(const std::vector<ConvexPart>& parts) {
  double sum = 0;
  for (const ConvexPart& part : parts) sum += volume_of(part.hull);
  return sum;
}

TEST(ConvexHull, of_a_box_is_the_box) {
  std::vector<Vector3> corners;
  for (int k = 0; k < 8; ++k) corners.emplace_back(k & 1, 2 * (k >> 1 & 1), 3 * (k >> 2 & 1));
  corners.emplace_back(0.5, 0.5, 0.5);
  const TriangleMesh hull = convex_hull(corners);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_NEAR(volume_of(hull), 6, 1e-9);
  EXPECT_TRUE(convex_hull({corners[0], corners[1], corners[2], corners[3]}).triangles.empty());
}

TEST(Voxels, a_cup_holds_what_its_shape_says_and_upside_down_nothing) {
  TriangleMesh mesh = cup();
  const auto held = [](const TriangleMesh& m) {
    const VoxelGrid grid = voxelize(m, 64);
    return static_cast<double>(cavity_of(grid).size()) * grid.cell_volume();
  };
  const double inside = std::numbers::pi * 0.034 * 0.034 * 0.094;
  EXPECT_NEAR(held(mesh), inside, 0.15 * inside);
  for (Vector3& v : mesh.vertices) v.z() = -v.z();
  EXPECT_EQ(held(mesh), 0);
}

TEST(ConvexParts, a_cylinder_and_a_box_are_one_part_each_and_stay_primitives) {
  const TriangleMesh can = turned({{0, 0}, {0.033, 0}, {0.033, 0.12}, {0, 0.12}}, 48);
  const auto parts = convex_parts(voxelize(can, 48), {});
  ASSERT_EQ(parts.size(), 1u);
  ASSERT_TRUE(std::holds_alternative<Cylinder>(parts[0].shape.shape));
  EXPECT_NEAR(std::get<Cylinder>(parts[0].shape.shape).radius, 0.033, 1e-4);
  EXPECT_NEAR(std::get<Cylinder>(parts[0].shape.shape).length, 0.12, 1e-6);
  const TriangleMesh box = convex_hull({{0, 0, 0},
                                        {0.1, 0, 0},
                                        {0, 0.05, 0},
                                        {0.1, 0.05, 0},
                                        {0, 0, 0.03},
                                        {0.1, 0, 0.03},
                                        {0, 0.05, 0.03},
                                        {0.1, 0.05, 0.03}});
  const auto one = convex_parts(voxelize(box, 48), {});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Box>(one[0].shape.shape));
}

TEST(ConvexParts, a_cup_is_cut_until_its_hollow_is_free) {
  const VoxelGrid grid = voxelize(cup(), 48);
  const double solid = std::numbers::pi * (0.04 * 0.04 * 0.1 - 0.034 * 0.034 * 0.094);
  const auto parts = convex_parts(grid, {.max_parts = 24});
  EXPECT_GE(parts.size(), 7u);
  EXPECT_LE(parts.size(), 30u);
  EXPECT_LT(volume_of_parts(parts), 1.6 * solid);
  EXPECT_GT(volume_of_parts(parts), 0.8 * solid);
  EXPECT_LT(volume_of_parts(parts), 0.6 * volume_of(convex_hull(cup().vertices)));
}

}  // namespace
}  // namespace handsel::solid_test
