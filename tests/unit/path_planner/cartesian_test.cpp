// SPDX-License-Identifier: Apache-2.0
// Cartesian planning for Jido beside its table with the elbow angle active: random configurations
// to reachable tool poses. Results are checked by forward kinematics and an independent exact
// collision check. HANDSEL_QUERIES: number of queries; the label full plans 100.
#include "components/path_planner/cartesian.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/planar_arm.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::path_planner::cartesian_test {
namespace {

using ::testing::HasSubstr;
constexpr unsigned kSeed = 46;

class Cartesian : public ::testing::Test {
 protected:
  Cartesian() {
    scene_.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
    world_.set_scene(scene_);
    exact_.set_scene(scene_);
  }
  Vector random_posture() {
    std::uniform_real_distribution<double> unit(0, 1);
    Vector q = robot_.rest_configuration();
    do {
      for (int axis : arm_.axes) {
        const Axis& a = robot_.axes()[static_cast<std::size_t>(axis)];
        q[axis] = a.lower + unit(engine_) * (a.upper - a.lower);
      }
    } while (!world_.check(q).free);
    return q;
  }
  /// Returns a configuration on the branch of `start`: shoulder, elbow and wrist bend alike.
  Vector random_posture_like(const Vector& start) {
    while (true) {
      const Vector q = random_posture();
      bool same = true;
      for (const std::size_t middle : {1, 3, 5})
        same = same && q[arm_.axes[middle]] * start[arm_.axes[middle]] > 0;
      if (same) return q;
    }
  }
  Pose tool(const Vector& q) const { return robot_.link_pose(q, robot_.tool_link()); }

  /// Expects continuous, free joint motion inside the limits from the start to the goal.
  void expect_sound(const CartesianProblem& problem, const CartesianResult& result) {
    ASSERT_GE(result.samples.size(), 2u);
    EXPECT_EQ(result.samples.front(), problem.start);
    const Pose end = tool(result.samples.back());
    EXPECT_LT((end.matrix() - problem.T_root_goal.matrix()).cwiseAbs().maxCoeff(), 1e-6);
    for (std::size_t i = 1; i < result.samples.size(); ++i) {
      const Vector &a = result.samples[i - 1], &b = result.samples[i];
      const double joints = (b - a).lpNorm<Eigen::Infinity>();
      largest_ = std::max(largest_, joints);
      ASSERT_LE(joints, settings_.largest_step + 1e-9) << "a jump";
      const Vector3 between = 0.5 * (tool(a).translation() + tool(b).translation());
      ASSERT_LT((tool(0.5 * (a + b)).translation() - between).norm(), 0.005)
          << "the tool leaves its way between two samples";
      ASSERT_TRUE(exact_.check(b).free);
      ASSERT_TRUE(exact_.check(0.5 * (a + b)).free);
      for (int axis : arm_.axes) {
        const Axis& limits = robot_.axes()[static_cast<std::size_t>(axis)];
        ASSERT_GE(b[axis], limits.lower - 1e-9);
        ASSERT_LE(b[axis], limits.upper + 1e-9);
      }
    }
  }

  /// The k-th query's answer: sound, or printed why there is none.
  CartesianResult asked(int k, const Vector& start, const Pose& T_root_goal) {
    CartesianProblem problem;
    problem.start = start;
    problem.T_root_goal = T_root_goal;
    problem.seed = kSeed + static_cast<unsigned>(k);
    problem.budget = 1000000;
    CartesianResult result = plan_cartesian(robot_, world_, cost_, problem, settings_);
    if (result.solved)
      expect_sound(problem, result);
    else
      std::printf("query %d: %s\n", k, result.reason.c_str());
    return result;
  }

  const RobotModel robot_{RobotModel::load(std::filesystem::path(HANDSEL_SOURCE_DIR) /
                                           "deploy/robots/jido/jido.txtpb")};
  const Group& arm_{robot_.require_group("arm")};
  CollisionWorld world_{robot_, nullptr}, exact_{robot_, nullptr};
  HumanCost cost_{robot_, {}};
  Scene scene_;
  CartesianSettings settings_;
  std::mt19937 engine_{kSeed};
  double largest_{};
};

TEST_F(Cartesian, reaches_poses_with_the_elbow_active_and_no_joint_jumps) {
  const char* text = std::getenv("HANDSEL_QUERIES");
  const int queries = text == nullptr ? 10 : std::atoi(text);
  int solved = 0;
  double turned = 0;
  for (int k = 0; k < queries; ++k) {
    SCOPED_TRACE(k);
    const Vector start = random_posture();
    const CartesianResult result = asked(k, start, tool(random_posture_like(start)));
    if (!result.solved) continue;
    ++solved;
    for (std::size_t i = 1; i < result.nodes.size(); ++i)
      turned = std::max(turned, std::abs(std::remainder(
                                    result.nodes[i].elbow - result.nodes[0].elbow, 2 * M_PI)));
  }
  std::printf(
      "seed %u: %d of %d solved, largest joint step between samples %.3f rad, elbow turned by up "
      "to %.2f rad\n",
      kSeed, solved, queries, largest_, turned);
  EXPECT_GE(solved * 100, queries * 95);
  EXPECT_GT(turned, 0.1);
}

TEST_F(Cartesian, goals_on_other_branches_are_reached_through_the_joints) {
  const char* text = std::getenv("HANDSEL_QUERIES");
  const int queries = text == nullptr ? 10 : std::atoi(text);
  int solved = 0, over = 0;
  for (int k = 0; k < queries; ++k) {
    SCOPED_TRACE(k);
    const Vector start = random_posture();
    const CartesianResult result = asked(k, start, tool(random_posture()));
    if (!result.solved) continue;
    ++solved;
    over += result.in_joints > 0;
    ASSERT_LT(result.in_joints, result.samples.size());
  }
  std::printf("seed %u: %d of %d goals anywhere reached, %d over another branch\n", kSeed, solved,
              queries, over);
  EXPECT_GE(solved * 100, queries * 90);
  EXPECT_GT(over, 0);
}

TEST_F(Cartesian, heeds_a_person_and_moves_hand_and_head_too) {
  const HumanState people = test::person_at({1.5, 0.2, 0});
  world_.set_people(people);
  exact_.set_people(people);
  cost_.set_people(people);
  CartesianProblem problem;
  problem.start = robot_.rest_configuration();
  problem.T_root_goal = tool(random_posture_like(problem.start));
  problem.also = robot_.require_group("head").axes;
  problem.also_goal = Vector::Constant(2, 0.2);
  problem.budget = 1000000;
  const CartesianResult result = plan_cartesian(robot_, world_, cost_, problem, settings_);
  ASSERT_TRUE(result.solved) << result.reason;
  expect_sound(problem, result);
  EXPECT_GT(result.cost, 0.0);
  for (int axis : problem.also) EXPECT_NEAR(result.samples.back()[axis], 0.2, 1e-9);
}

TEST_F(Cartesian, says_why_not) {
  CartesianProblem problem;
  const auto reason = [&] {
    return plan_cartesian(robot_, world_, cost_, problem, settings_).reason;
  };
  EXPECT_THAT(reason(), HasSubstr("start"));
  problem.start = robot_.rest_configuration();
  problem.T_root_goal = make_pose({5, 0, 1});
  EXPECT_THAT(reason(), HasSubstr("no configuration"));
  problem.T_root_goal = make_pose({0.85, -0.62, 0.5});
  EXPECT_THAT(reason(), ::testing::AnyOf(HasSubstr("box table"), HasSubstr("no configuration")));
  problem.T_root_goal = tool(random_posture_like(problem.start));
  problem.budget = 0;
  EXPECT_THAT(reason(), HasSubstr("time limit is zero"));
  problem.budget = 1000000;
  problem.also = {arm_.axes[0]};
  problem.also_goal = Vector::Zero(1);
  EXPECT_THAT(reason(), HasSubstr("besides the arm"));
  const RobotModel planar = test::planar_arm();
  CollisionWorld world(planar, nullptr);
  HumanCost cost(planar, {});
  CartesianProblem other;
  other.start = Vector::Zero(3);
  EXPECT_THAT(plan_cartesian(planar, world, cost, other, settings_).reason,
              HasSubstr("group \"arm\""));
}

TEST_F(Cartesian, the_same_seed_gives_the_same_path) {
  CartesianProblem problem;
  problem.start = random_posture();
  problem.T_root_goal = tool(random_posture_like(problem.start));
  problem.budget = 1000000;
  const CartesianResult a = plan_cartesian(robot_, world_, cost_, problem, settings_),
                        b = plan_cartesian(robot_, world_, cost_, problem, settings_);
  EXPECT_EQ(a.samples, b.samples);
}

}  // namespace
}  // namespace handsel::path_planner::cartesian_test
