// SPDX-License-Identifier: Apache-2.0
// Force closure and epsilon against an independent hull (Qhull) on random contact sets, and against
// closed-form solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "components/grasp_planner/list/epsilon.hpp"
#include "tests/support/oracles/hull_oracle.hpp"

namespace handsel::grasp_planner::grasp_stability_test {
namespace {

using test::hull_oracle;

std::vector<PointContact> random_contacts(std::mt19937_64& random, int count, bool on_grid) {
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> grid(-1, 1);
  std::uniform_real_distribution<double> friction(0.1, 1.0);
  const double mu = on_grid ? 0.5 : friction(random);
  std::vector<PointContact> contacts;
  while (static_cast<int>(contacts.size()) < count) {
    Vector3 p, n;
    for (int i = 0; i < 3; ++i) {
      p[i] = on_grid ? grid(random) : normal(random);
      n[i] = on_grid ? grid(random) : -p[i] + 0.7 * normal(random);
    }
    if (n.norm() < 0.1) continue;
    contacts.push_back({p, n.normalized(), mu});
  }
  return contacts;
}

TEST(GraspStability, agrees_with_an_independent_hull_on_random_contacts) {
  const std::uint64_t seed = 20260101;
  std::mt19937_64 random(seed);
  int closed = 0, compared = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const int count = 2 + trial % 4;
    const WrenchMatrix w =
        contact_wrenches(random_contacts(random, count, false), 8, Vector3::Zero(), 1.0);
    const double hull = hull_oracle(w), oracle = std::isnan(hull) ? -1 : hull;  // flat: not closed
    if (std::abs(oracle) < 1e-7) continue;
    ++compared;
    closed += oracle > 0;
    ASSERT_EQ(force_closure(w), oracle > 0)
        << "trial " << trial << " seed " << seed << " oracle " << oracle;
    ASSERT_NEAR(epsilon(w), std::max(0.0, oracle), 1e-9) << "trial " << trial << " seed " << seed;
  }
  EXPECT_GT(closed, 40);
  EXPECT_GT(compared, 500);
}

TEST(GraspStability, survives_contacts_on_a_coarse_grid) {
  const std::uint64_t seed = 7;
  std::mt19937_64 random(seed);
  for (int trial = 0; trial < 400; ++trial) {
    const WrenchMatrix w =
        contact_wrenches(random_contacts(random, 2 + trial % 4, true), 8, Vector3::Zero(), 1.0);
    const double e = epsilon(w);
    ASSERT_EQ(force_closure(w), e > 0) << "trial " << trial << " seed " << seed << " epsilon " << e;
    const double oracle = hull_oracle(w);
    if (oracle > 1e-7) {
      ASSERT_NEAR(e, oracle, 1e-9) << "trial " << trial << " seed " << seed;
    }
  }
}

TEST(GraspStability, epsilon_of_regular_sets_is_their_inner_radius) {
  for (int d = 1; d <= 7; ++d) {
    WrenchMatrix cross(d, 2 * d);
    cross << Eigen::MatrixXd::Identity(d, d), -Eigen::MatrixXd::Identity(d, d);
    EXPECT_NEAR(epsilon(cross), 1 / std::sqrt(d), 1e-12) << d;
    EXPECT_TRUE(force_closure(cross)) << d;
  }
  WrenchMatrix cube(3, 8);
  for (int i = 0; i < 8; ++i) cube.col(i) << (i & 1 ? 1 : -1), (i & 2 ? 1 : -1), (i & 4 ? 1 : -1);
  EXPECT_NEAR(epsilon(cube), 1.0, 1e-12);
  WrenchMatrix triangle(2, 3);
  triangle << 1, -0.5, -0.5, 0, std::sqrt(0.75), -std::sqrt(0.75);
  EXPECT_NEAR(epsilon(triangle), 0.5, 1e-12);
}

TEST(GraspStability, two_hard_contacts_are_never_closed) {
  const std::vector<PointContact> pinch = {{{0.03, 0, 0}, {-1, 0, 0}, 0.8},
                                           {{-0.03, 0, 0}, {1, 0, 0}, 0.8}};
  const WrenchMatrix w = contact_wrenches(pinch, 8, Vector3::Zero(), 30);
  EXPECT_EQ(wrench_rank(w), 5);
  EXPECT_FALSE(force_closure(w));
  EXPECT_EQ(epsilon(w), 0.0);
}

TEST(GraspStability, closure_is_strict_at_the_border) {
  WrenchMatrix w(2, 3);
  w << 1, -1, 0, 0, 0, 1;  // the origin lies on an edge of the hull
  EXPECT_FALSE(force_closure(w));
  EXPECT_EQ(epsilon(w), 0.0);
  WrenchMatrix inside(2, 4);
  inside << 1, -1, 0, 0, 0, 0, 1, -1e-6;
  EXPECT_TRUE(force_closure(inside));
  EXPECT_NEAR(epsilon(inside), 1e-6, 1e-11);
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_stability_test
