// SPDX-License-Identifier: Apache-2.0
// The Panda problems of the reference data: the number solved in five seconds, and FCL's check of
// every path at every millimetre and half degree. HANDSEL_RUNS: number of problems (14, spread over
// the scenes; 0: all).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <gtest/gtest.h>

#include "components/path_planner/path_planner.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/processes/thread_time.hpp"

namespace handsel::path_planner::panda_paths_test {
namespace {

constexpr double kTimeLimit = 5.0;    // max time of a problem [s]
constexpr double kReach = 1.4;        // max distance of a point of arm and hand from an axis [m]
constexpr double kMaxMotion = 0.001;  // max motion of a point of the robot between two states [m]
// Max rotation of an axis between two states [rad].
constexpr double kMaxTurn = 0.5 * std::numbers::pi / 180;

TEST(PandaPaths, are_found_in_time_and_free_by_the_exact_check) {
  if (!test::reference_data("problems/panda")) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const char* asked = std::getenv("HANDSEL_RUNS");
  const RobotModel robot = test::load_panda();
  const std::vector<test::PandaProblem> problems = test::panda_problems(robot);
  const std::size_t runs = asked == nullptr       ? 14
                           : std::atoi(asked) > 0 ? std::atoi(asked)
                                                  : problems.size();
  CollisionWorld world(robot, nullptr), exact(robot, nullptr);
  HumanCost nobody(robot, {});
  std::vector<double> times;
  std::size_t states = 0;
  const std::size_t stride = std::max<std::size_t>(1, problems.size() / runs);
  std::size_t tried = 0;
  for (std::size_t k = 0; k < problems.size() && tried < runs; k += stride) {
    ++tried;
    world.set_obstacles(problems[k].obstacles);
    exact.set_obstacles(problems[k].obstacles);
    Problem problem;
    problem.axes = test::panda_arm(robot);
    problem.start = problems[k].start;
    const auto part = [&](const Vector& q) {
      Vector out(problem.axes.size());
      for (std::size_t i = 0; i < problem.axes.size(); ++i)
        out[static_cast<Eigen::Index>(i)] = q[problem.axes[i]];
      return out;
    };
    for (const Vector& goal : problems[k].goals) problem.goals.push_back(part(goal));
    problem.budget = UINT64_MAX / 2;
    const double begin = test::thread_time();
    Hooks hooks;
    hooks.cancelled = [&] { return test::thread_time() - begin > kTimeLimit; };
    const Result result = plan(robot, world, nobody, problem, {}, hooks);
    if (!result.solved) {
      std::printf("problem %zu (%s): %s\n", k, problems[k].set.c_str(), result.reason.c_str());
      continue;
    }
    times.push_back(test::thread_time() - begin);
    EXPECT_EQ(result.path.front(), part(problem.start));
    EXPECT_EQ(result.path.back(), problem.goals[result.goal]);
    Vector from = problem.start, to = problem.start;
    for (std::size_t i = 1; i < result.path.size(); ++i) {
      for (std::size_t axis = 0; axis < problem.axes.size(); ++axis) {
        from[problem.axes[axis]] = result.path[i - 1][static_cast<Eigen::Index>(axis)];
        to[problem.axes[axis]] = result.path[i][static_cast<Eigen::Index>(axis)];
      }
      const Vector along = (to - from).cwiseAbs();
      const int pieces =
          std::max(1, static_cast<int>(std::ceil(std::max(along.sum() * kReach / kMaxMotion,
                                                          along.maxCoeff() / kMaxTurn))));
      for (int piece = 0; piece <= pieces; ++piece, ++states) {
        const Vector q = from + (static_cast<double>(piece) / pieces) * (to - from);
        ASSERT_TRUE(exact.is_free(q)) << "problem " << k << " (" << problems[k].set << "), edge "
                                      << i << " at " << piece << " of " << pieces;
        for (int axis : problem.axes) {
          ASSERT_GE(q[axis], robot.axes()[axis].lower - 1e-9) << "problem " << k;
          ASSERT_LE(q[axis], robot.axes()[axis].upper + 1e-9) << "problem " << k;
        }
      }
    }
  }
  EXPECT_EQ(exact.checks(), exact.exact_checks());
  std::sort(times.begin(), times.end());
  std::printf(
      "%zu of %zu problems solved, median %.2f ms, longest %.0f ms; %zu states of their paths "
      "judged by FCL, all free\n",
      times.size(), tried, 1e3 * (times.empty() ? 0 : times[times.size() / 2]),
      1e3 * (times.empty() ? 0 : times.back()), states);
  EXPECT_GE(static_cast<double>(times.size()), 0.99 * static_cast<double>(tried));
}

}  // namespace
}  // namespace handsel::path_planner::panda_paths_test
