// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/placement.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/model/object_model.hpp"

namespace handsel::placement_test {
namespace {

TriangleMesh box(const Vector3& size, const Vector3& at = Vector3::Zero()) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        at + size.cwiseProduct(Vector3(i & 1, i >> 1 & 1, i >> 2) - Vector3::Constant(0.5)));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST(MassProperties, of_a_box_are_those_of_the_book) {
  const Vector3 size(0.1, 0.2, 0.3), at(0.4, -0.2, 1.0);
  const MassProperties p = mass_properties(box(size, at));
  EXPECT_NEAR(p.volume, size.prod(), 1e-12);
  EXPECT_LT((p.com - at).norm(), 1e-12);
  const Vector3 squares = size.cwiseProduct(size);
  const Vector3 wanted =
      Vector3(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y()) / 12;
  EXPECT_LT((p.inertia_per_mass - Eigen::Matrix3d(wanted.asDiagonal())).norm(), 1e-12);
}

TEST(MassProperties, turn_with_the_object) {
  TriangleMesh mesh = box({0.1, 0.2, 0.3}, {0.1, 0, 0});
  const MassProperties before = mass_properties(mesh);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()).toRotationMatrix();
  for (Vector3& p : mesh.vertices) p = R * p + Vector3(1, 2, 3);
  const MassProperties after = mass_properties(mesh);
  EXPECT_LT((after.inertia_per_mass - R * before.inertia_per_mass * R.transpose()).norm(), 1e-12);
  EXPECT_LT((after.com - (R * before.com + Vector3(1, 2, 3))).norm(), 1e-12);
}

TEST(MassProperties, of_a_surface_inside_out_have_no_volume) {
  TriangleMesh mesh = box({1, 1, 1});
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_LE(mass_properties(mesh).volume, 0);
  EXPECT_TRUE(stable_placements(TriangleMesh{}, Vector3::Zero()).empty());
}

TEST(Placements, a_box_stands_on_six_faces_the_flattest_first) {
  const std::vector<Placement> found = stable_placements(box({0.1, 0.2, 0.3}), Vector3::Zero());
  ASSERT_EQ(found.size(), 6u);
  EXPECT_NEAR(found[0].height, 0.05, 1e-9);
  EXPECT_NEAR(found[0].margin, 0.1, 1e-9);
  EXPECT_NEAR(found[0].tipping, std::atan2(0.1, 0.05), 1e-9);
  EXPECT_NEAR(found[0].area, 0.06, 1e-9);
  EXPECT_NEAR(found[5].height, 0.15, 1e-9);
  for (const Placement& p : found) {
    EXPECT_LT((p.T_support_object * Vector3::Zero() - Vector3(0, 0, p.height)).norm(), 1e-9);
    double lowest = 1;
    for (const Vector3& v : box({0.1, 0.2, 0.3}).vertices)
      lowest = std::min(lowest, (p.T_support_object * v).z());
    EXPECT_NEAR(lowest, 0, 1e-9);
  }
}

TEST(Placements, what_leans_too_far_over_is_left_out) {
  // Mass centre near one end: the object rests only on faces below the mass centre.
  const std::vector<Placement> found = stable_placements(box({0.1, 0.1, 0.4}), {0.049, 0, 0});
  for (const Placement& p : found) {
    EXPECT_GE(p.tipping, 0.1);
    const Vector3 down = p.T_support_object.linear().transpose() * -Vector3::UnitZ();
    EXPECT_LT(std::abs(down.z()), 0.5) << "it stands on an end, a millimetre from tipping over";
  }
  EXPECT_GE(found.size(), 2u);
}

TEST(Placements, a_tetrahedron_stands_on_any_face_and_nothing_is_below_the_support) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  for (int k = 0; k < 50; ++k) {
    TriangleMesh cloud;
    for (int i = 0; i < 40; ++i)
      cloud.vertices.emplace_back(0.1 * any(random), 0.05 * any(random), 0.02 * any(random));
    Vector3 com = Vector3::Zero();
    for (const Vector3& v : cloud.vertices) com += v / 40;
    const std::vector<Placement> found = stable_placements(cloud, com, 0.0);
    EXPECT_FALSE(found.empty()) << "something always stands";
    for (const Placement& p : found) {
      EXPECT_LT(((p.T_support_object * com).head<2>()).norm(), 1e-9);
      int touching = 0;
      for (const Vector3& v : cloud.vertices) {
        const double z = (p.T_support_object * v).z();
        EXPECT_GT(z, -1e-3);
        touching += z < 1e-3;
      }
      EXPECT_GE(touching, 3);
    }
  }
}

TEST(Placements, the_mug_stands_upright) {
  const ObjectModel mug =
      ObjectModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/objects/mug/mug.txtpb");
  const std::vector<Placement> found = stable_placements(mug.mesh, mug.com);
  ASSERT_FALSE(found.empty());
  bool upright = false;
  for (const Placement& p : found)
    upright = upright || (p.T_support_object.linear() * Vector3::UnitZ()).z() > 0.999;
  EXPECT_TRUE(upright);
}

}  // namespace
}  // namespace handsel::placement_test
