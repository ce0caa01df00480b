// SPDX-License-Identifier: Apache-2.0
// An interrupted path is rejoined near the point of interruption.
#include "components/trajectory_controller/arm/path_runner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"

namespace handsel::trajectory_controller::path_runner_test {
namespace {

constexpr double kPeriod = 0.001;  // control period [s]

MotionState3 rest_at(double a, double b) { return rest_state(Eigen::Vector2d(a, b)); }

TEST(PathRunner, a_path_rejoined_before_a_corner_does_not_cut_it) {
  const KinematicLimits limits{Eigen::Vector2d::Constant(1.0), Eigen::Vector2d::Constant(3.0),
                               Eigen::Vector2d::Constant(20.0)};
  const double first_leg = solve(rest_at(0, 0), rest_at(0.4, 0), limits).trajectory.duration();
  double most_off = 0.0;
  for (const double before_corner : {0.5, 0.4, 0.3, 0.2, 0.1}) {  // [s]
    Trajectory path = solve(rest_at(0, 0), rest_at(0.4, 0), limits).trajectory;
    append(path, solve(rest_at(0.4, 0), rest_at(0.4, 0.4), limits).trajectory);
    PathRunner runner({.period = kPeriod});
    ASSERT_EQ(
        runner.start(path, {limits, Eigen::Vector2d::Constant(-3), Eigen::Vector2d::Constant(3)}),
        "");
    while (runner.time() < first_leg - before_corner) ASSERT_TRUE(runner.step(1.0));
    const Eigen::Vector2d left = runner.state().position;
    ASSERT_TRUE(runner.rejoin(rest_at(left[0], 0.003))) << before_corner;
    for (int k = 0; k < 5000 && !runner.finished(); ++k) {
      ASSERT_TRUE(runner.step(1.0));
      const Eigen::VectorXd& at = runner.state().position;
      const double off_first = std::max({std::abs(at[1]), at[0] - 0.4, 0.0}),
                   off_second = std::max({std::abs(at[0] - 0.4), -at[1], 0.0});
      most_off = std::max(most_off, std::min(off_first, off_second));
    }
    EXPECT_TRUE(runner.finished());
  }
  std::printf("at most %.4f rad beside the path\n", most_off);
  EXPECT_LT(most_off, 0.03);
}

}  // namespace
}  // namespace handsel::trajectory_controller::path_runner_test
