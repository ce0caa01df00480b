// SPDX-License-Identifier: Apache-2.0
// Random contact sets: the strict test of force closure against an independent linear program
// (GLPK), and epsilon against an independent hull (Qhull). HANDSEL_RUNS: number of sets (400).
#include <gtest/gtest.h>

#include <glpk.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "components/grasp_planner/list/epsilon.hpp"
#include "tests/support/motion_draw.hpp"
#include "tests/support/oracles/hull_oracle.hpp"

namespace handsel::grasp_planner::grasp_oracles_test {
namespace {

/// Returns the max t with W lambda = 0, sum of lambda = 1, lambda >= t; -1: none.
double closure_oracle(const WrenchMatrix& w) {
  const int rows = static_cast<int>(w.rows()), n = static_cast<int>(w.cols());
  // lambda = t + mu, mu >= 0: W mu + (W 1) t = 0, sum of mu + n t = 1.
  glp_prob* lp = glp_create_prob();
  glp_set_obj_dir(lp, GLP_MAX);
  glp_add_rows(lp, rows + 1);
  for (int i = 1; i <= rows; ++i) glp_set_row_bnds(lp, i, GLP_FX, 0, 0);
  glp_set_row_bnds(lp, rows + 1, GLP_FX, 1, 1);
  glp_add_cols(lp, n + 1);
  std::vector<int> index(static_cast<std::size_t>(rows) + 2);
  std::vector<double> value(index.size());
  for (int j = 1; j <= n + 1; ++j) {
    if (j <= n) glp_set_col_bnds(lp, j, GLP_LO, 0, 0);
    if (j > n) glp_set_col_bnds(lp, j, GLP_FR, 0, 0);
    for (int i = 1; i <= rows; ++i) {
      index[static_cast<std::size_t>(i)] = i;
      value[static_cast<std::size_t>(i)] = j <= n ? w(i - 1, j - 1) : w.row(i - 1).sum();
    }
    index[static_cast<std::size_t>(rows) + 1] = rows + 1;
    value[static_cast<std::size_t>(rows) + 1] = j <= n ? 1 : n;
    glp_set_mat_col(lp, j, rows + 1, index.data(), value.data());
  }
  glp_set_obj_coef(lp, n + 1, 1);
  glp_smcp settings;
  glp_init_smcp(&settings);
  settings.msg_lev = GLP_MSG_OFF;
  glp_simplex(lp, &settings);
  const double t = glp_get_status(lp) == GLP_OPT ? glp_get_obj_val(lp) : -1;
  glp_delete_prob(lp);
  return t;
}

std::vector<PointContact> random_contacts(std::mt19937_64& random, int count) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> friction(0.1, 1.0);
  const double mu = friction(random);
  // From random points and normals to opposed contacts on a body, which are more often closed.
  const double facing = std::uniform_real_distribution<double>(0, 3)(random);
  std::vector<PointContact> contacts;
  while (static_cast<int>(contacts.size()) < count) {
    const Vector3 p(normal(random), normal(random), normal(random)),
        any(normal(random), normal(random), normal(random));
    const Vector3 n = any - facing * p;
    if (n.norm() > 0.1) contacts.push_back({p, n.normalized(), mu});
  }
  return contacts;
}

TEST(GraspOracles,
     strict_closure_agrees_with_a_linear_program_and_epsilon_with_a_hull_on_all_sets) {
  const std::uint64_t seed = 20260301;
  std::mt19937_64 random(seed);
  glp_term_out(GLP_OFF);
  const int runs = test::runs(400);
  int closed = 0, hulls = 0, at_border = 0;
  double largest = 0;
  for (int trial = 0; trial < runs; ++trial) {
    const int count = 2 + trial % 5, edges = 6 + 2 * (trial / 5 % 4);
    const WrenchMatrix w =
        contact_wrenches(random_contacts(random, count), edges, Vector3::Zero(), 1.0);
    const double t = closure_oracle(w);
    // Two opposed contacts balance; a third that turns the object about their line in one direction
    // only leaves t at 0: a frequent case without closure.
    const bool expected = t > 1e-9 && wrench_rank(w) == 6;
    at_border += std::abs(t) <= 1e-9;
    ASSERT_EQ(force_closure(w), expected) << "trial " << trial << " seed " << seed << " t " << t;
    closed += expected;
    const double hull = test::hull_oracle(w), e = epsilon(w);
    if (std::isnan(hull)) {
      EXPECT_EQ(e, 0.0) << "trial " << trial << " seed " << seed
                        << ": a set that does not span the space";
      continue;
    }
    ++hulls;
    largest = std::max(largest, std::abs(e - std::max(0.0, hull)));
    ASSERT_NEAR(e, std::max(0.0, hull), 1e-9) << "trial " << trial << " seed " << seed;
  }
  std::printf(
      "%d sets, %d closed, %d at the border: closure as the linear program on all; %d hulls, "
      "largest difference of epsilon %.1e\n",
      runs, closed, at_border, hulls, largest);
  EXPECT_GT(closed, runs / 10);
  EXPECT_GT(hulls, runs / 2);
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_oracles_test
