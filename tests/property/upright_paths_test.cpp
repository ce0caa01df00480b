// SPDX-License-Identifier: Apache-2.0
// The held object stays upright and every axis within its limits at every sample of every path:
// random queries with and without a person. HANDSEL_RUNS: number of queries (10).
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "components/path_planner/path_planner.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::path_planner::upright_paths_test {
namespace {

constexpr unsigned kSeed = 77;
constexpr double kTiltBound = 0.35;  // max tilt of the held object [rad]
constexpr double kSampling = 0.002;  // step between samples, max norm [rad]

TEST(UprightPaths, keep_tilt_and_limits_on_every_sample) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  CollisionWorld world(robot, nullptr);
  HumanCost cost(robot, {});
  Scene scene;
  scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
  world.set_scene(scene);
  Problem problem;
  problem.axes = robot.require_group("arm").axes;
  problem.upright = Upright{Vector3::UnitZ(), Vector3::UnitZ(), kTiltBound};
  problem.budget = 400000;
  std::mt19937 random(kSeed);
  const auto tilt = [&](const Vector& q) {
    return std::acos(std::clamp(robot.link_pose(q, robot.tool_link()).linear()(2, 2), -1.0, 1.0));
  };
  const auto draw = [&] {
    Vector q = robot.rest_configuration();
    do {
      for (int axis : problem.axes)
        q[axis] = std::uniform_real_distribution<double>(robot.axes()[axis].lower,
                                                         robot.axes()[axis].upper)(random);
    } while (tilt(q) > kTiltBound || !world.check(q).free);
    return q;
  };
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int queries = asked != nullptr ? std::atoi(asked) : 10;
  int solved = 0, lines_that_lean = 0;
  std::size_t samples = 0;
  double max_tilt = 0;
  for (int k = 0; k < queries; ++k) {
    const HumanState people = k % 2 == 1 ? test::person_at({1.2, 0.05, 0}) : HumanState{};
    world.set_people(people);
    cost.set_people(people);
    problem.start = draw();
    const Vector goal = draw();
    problem.goals = {Vector(problem.axes.size())};
    for (std::size_t i = 0; i < problem.axes.size(); ++i)
      problem.goals[0][static_cast<Eigen::Index>(i)] = goal[problem.axes[i]];
    problem.seed = kSeed + static_cast<unsigned>(k);
    bool leans = false;
    for (double t = 0; t <= 1; t += 0.01)
      leans = leans || tilt(problem.start + t * (goal - problem.start)) > kTiltBound;
    lines_that_lean += leans;
    const Result result = plan(robot, world, cost, problem, {});
    if (!result.solved) {
      std::printf("query %d: %s\n", k, result.reason.c_str());
      continue;
    }
    ++solved;
    Vector q = problem.start;
    for (std::size_t i = 1; i < result.path.size(); ++i) {
      const Vector along = result.path[i] - result.path[i - 1];
      const int pieces =
          std::max(1, static_cast<int>(std::ceil(along.cwiseAbs().maxCoeff() / kSampling)));
      for (int piece = 0; piece <= pieces; ++piece, ++samples) {
        const Vector part = result.path[i - 1] + (static_cast<double>(piece) / pieces) * along;
        for (std::size_t axis = 0; axis < problem.axes.size(); ++axis) {
          q[problem.axes[axis]] = part[static_cast<Eigen::Index>(axis)];
          ASSERT_GE(q[problem.axes[axis]], robot.axes()[problem.axes[axis]].lower - 1e-9)
              << "query " << k;
          ASSERT_LE(q[problem.axes[axis]], robot.axes()[problem.axes[axis]].upper + 1e-9)
              << "query " << k;
        }
        max_tilt = std::max(max_tilt, tilt(q));
        ASSERT_LE(tilt(q), kTiltBound + 1e-6) << "query " << k;
      }
    }
  }
  std::printf(
      "seed %u: %d of %d solved, the straight line leans too far in %d; largest tilt %.4f of %.2f "
      "rad in %zu samples\n",
      kSeed, solved, queries, lines_that_lean, max_tilt, kTiltBound, samples);
  EXPECT_GT(lines_that_lean, queries / 2);
  EXPECT_GE(solved, queries * 9 / 10);
}

TEST(UprightPaths, a_start_or_goal_that_leans_and_a_bound_that_means_nothing_are_named) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  CollisionWorld world(robot, nullptr);
  HumanCost cost(robot, {});
  Problem problem;
  problem.axes = robot.require_group("arm").axes;
  problem.start = robot.rest_configuration();
  problem.goals = {RobotModel::part(problem.start, robot.require_group("arm"))};
  const Vector3 up =
      robot.link_pose(problem.start, robot.tool_link()).linear().transpose() * Vector3::UnitX();
  problem.upright = Upright{up, Vector3::UnitZ(), 0.2};
  EXPECT_NE(plan(robot, world, cost, problem, {})
                .reason.find("the start: what is held leans 1.571 rad over"),
            std::string::npos);
  problem.upright->max_angle = 0;
  EXPECT_NE(plan(robot, world, cost, problem, {}).reason.find("the bound must be above 0"),
            std::string::npos);
}

}  // namespace
}  // namespace handsel::path_planner::upright_paths_test
