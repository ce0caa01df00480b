// SPDX-License-Identifier: Apache-2.0
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>

#include "components/path_planner/path_planner.hpp"
#include "components/path_planner/search/ompl_planner.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/oracles/sound_path.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel::path_planner::path_planner_test {
namespace {

using ::testing::HasSubstr;

class Planning : public ::testing::Test {
 protected:
  Planning() {
    Scene scene;
    scene.boxes.push_back({"wall", make_pose({0.75, 0, 0}), {0.3, 0.06, 0.4}, false});
    world_.set_scene(scene);
    problem_.axes = {0, 1, 2};
    problem_.start = Vector3(-0.6, 0, 0);
    problem_.goals = {Vector3(0.6, 0, 0)};
  }
  void put_person(const Vector3& feet) {
    HumanState state;
    Person person;
    person.id = "anna";
    person.joints = standing_body(feet, std::atan2(-feet.y(), -feet.x()), 1.75);
    state.people.push_back(person);
    world_.set_base(make_pose({0, 0, 1.1}));
    world_.set_people(state);
    cost_.set_base(make_pose({0, 0, 1.1}));
    cost_.set_people(state);
  }
  Result solve() { return plan(robot_, world_, cost_, problem_, settings_); }
  void expect_sound(const Result& result) { test::expect_sound(result, problem_, world_); }

  RobotModel robot_{test::planar_arm()};
  CollisionWorld world_{robot_, nullptr};
  HumanCost cost_{robot_, {}};
  Problem problem_;
  Settings settings_;
};

TEST_F(Planning, goes_around_a_wall) {
  ASSERT_FALSE(world_.check_motion(problem_.start, problem_.goals[0]).free);
  const Result result = solve();
  expect_sound(result);
  EXPECT_EQ(result.planner, "rrtconnect");
  EXPECT_GT(result.length, 1.2);
  EXPECT_GT(result.checks, 0u);
  EXPECT_EQ(result.cost, 0.0);
}

TEST_F(Planning, takes_the_straight_line_where_it_is_free) {
  world_.set_scene({});
  const Result result = solve();
  expect_sound(result);
  EXPECT_EQ(result.path.size(), 2u);
  EXPECT_NEAR(result.length, 1.2, 1e-9);
}

TEST_F(Planning, every_planner_finds_a_way) {
  put_person({2.2, 0.5, 0});
  Scene scene;
  scene.boxes.push_back({"wall", make_pose({0.75, 0, 1.1}), {0.3, 0.06, 0.4}, false});
  world_.set_scene(scene);
  for (PlannerKind kind :
       {PlannerKind::rrt, PlannerKind::rrt_connect, PlannerKind::trrt, PlannerKind::bitrrt})
    for (const bool stock : {false, true}) {
      if (stock && kind == PlannerKind::trrt)
        continue;  // OMPL's temperature falls so fast that the planner often fails
      problem_.planner = kind;
      problem_.stock = stock;
      problem_.budget = 600000;
      const Result result = solve();
      SCOPED_TRACE(static_cast<int>(kind));
      expect_sound(result);
      EXPECT_GT(result.cost, 0.0);
    }
}

TEST_F(Planning, ours_are_planners_of_ompl) {
  namespace ob = ompl::base;
  put_person({2.2, 0.5, 0});
  const Hooks hooks;
  for (PlannerKind kind : {PlannerKind::rrt_connect, PlannerKind::trrt, PlannerKind::bitrrt}) {
    problem_.budget = 600000;
    world_.set_moving_axes(problem_.axes);
    cost_.set_moving_axes(problem_.axes);
    SearchSpace space(robot_, world_, cost_, problem_, settings_, hooks);
    const auto joints = std::make_shared<ob::RealVectorStateSpace>(3);
    joints->setBounds(-2.9, 2.9);
    const auto si = std::make_shared<ob::SpaceInformation>(joints);
    si->setStateValidityChecker([](const ob::State*) { return true; });
    si->setup();
    const auto definition = std::make_shared<ob::ProblemDefinition>(si);
    ob::ScopedState<ob::RealVectorStateSpace> start(si), goal(si);
    for (unsigned i = 0; i < 3; ++i) {
      start[i] = problem_.start[i];
      goal[i] = problem_.goals[0][i];
    }
    definition->setStartAndGoalStates(start, goal);
    const ob::PlannerPtr planner = std::make_shared<BatchPlanner>(si, space, kind, 3);
    planner->setProblemDefinition(definition);
    planner->setup();
    ASSERT_EQ(planner->solve(ob::PlannerTerminationCondition([&] { return space.exhausted(); })),
              ob::PlannerStatus::EXACT_SOLUTION);
    ASSERT_TRUE(definition->hasExactSolution());
    ob::PlannerData data(si);
    planner->getPlannerData(data);
    EXPECT_GT(data.numVertices(), 2u);
    EXPECT_EQ(data.numStartVertices(), 1u);
    const auto& states =
        definition->getSolutionPath()->as<ompl::geometric::PathGeometric>()->getStates();
    std::vector<Vector> path;
    for (const ob::State* state : states)
      path.push_back(
          Eigen::Map<const Vector>(state->as<ob::RealVectorStateSpace::StateType>()->values, 3));
    EXPECT_EQ(path.front(), problem_.start);
    EXPECT_EQ(path.back(), problem_.goals[0]);
    for (std::size_t i = 1; i < path.size(); ++i)
      EXPECT_TRUE(world_.check_motion(path[i - 1], path[i], 0.002).free);
    planner->clear();
    EXPECT_FALSE(planner->solve(ob::PlannerTerminationCondition([] { return true; })) ==
                 ob::PlannerStatus::EXACT_SOLUTION)
        << "stops at once";
  }
}

TEST_F(Planning, the_same_seed_gives_the_same_path_also_after_other_plans) {
  for (PlannerKind kind :
       {PlannerKind::rrt, PlannerKind::rrt_connect, PlannerKind::trrt, PlannerKind::bitrrt}) {
    problem_.planner = kind;
    problem_.seed = 5;
    const Result first = solve();
    problem_.seed = 6;
    const Result other = solve();
    problem_.seed = 5;
    const Result again = solve();
    ASSERT_TRUE(first.solved && other.solved && again.solved);
    EXPECT_EQ(first.path, again.path);
    EXPECT_EQ(first.checks, again.checks);
    EXPECT_NE(first.path, other.path);
  }
}

TEST_F(Planning, passes_over_a_goal_in_collision) {
  problem_.goals = {Vector3(0.0, 0, 0), Vector3(0.6, 0, 0)};
  const Result result = solve();
  expect_sound(result);
  EXPECT_EQ(result.goal, 1u);
}

TEST_F(Planning, keeps_the_axes_it_does_not_plan_for) {
  problem_.axes = {1, 2};
  problem_.start = Vector3(-0.6, 0, 0);
  problem_.goals = {Vector::Constant(2, 0.5)};
  const Result result = solve();
  ASSERT_TRUE(result.solved) << result.reason;
  EXPECT_EQ(result.path.front().size(), 2);
}

TEST_F(Planning, a_start_in_collision_says_with_what) {
  problem_.start = Vector3(0, 0, 0);
  const Result result = solve();
  EXPECT_FALSE(result.solved);
  EXPECT_THAT(result.reason, HasSubstr("start is in collision"));
  EXPECT_THAT(result.reason, HasSubstr("box wall"));
}

TEST_F(Planning, a_goal_in_collision_says_with_what) {
  problem_.goals = {Vector3(0, 0, 0), Vector3(0.02, 0, 0)};
  const Result result = solve();
  EXPECT_FALSE(result.solved);
  EXPECT_THAT(result.reason, HasSubstr("none of the 2 goals"));
  EXPECT_THAT(result.reason, HasSubstr("box wall"));
}

TEST_F(Planning, limits_dimensions_and_budgets_are_named) {
  problem_.goals = {Vector3(3.1, 0, 0)};
  EXPECT_THAT(solve().reason, HasSubstr("axis joint1 at 3.1000 is outside its limits"));
  problem_.goals = {Vector::Zero(2)};
  EXPECT_THAT(solve().reason, HasSubstr("a goal has 2 axes, the group has 3"));
  problem_.goals = {};
  EXPECT_THAT(solve().reason, HasSubstr("no goal"));
  problem_.goals = {Vector3(0.6, 0, 0)};
  problem_.budget = 0;
  EXPECT_THAT(solve().reason, HasSubstr("zero"));
}

TEST_F(Planning, what_cannot_be_reached_ends_with_the_closest_approach) {
  Scene scene;
  scene.boxes.push_back({"wall", make_pose({0.3, 0, 0}), {0.3, 0.06, 0.4}, false});
  scene.boxes.push_back({"back", make_pose({-0.3, 0, 0}), {0.3, 0.06, 0.4}, false});
  world_.set_scene(scene);
  problem_.budget = 5000;
  const Result result = solve();
  EXPECT_FALSE(result.solved);
  EXPECT_TRUE(result.path.empty());
  EXPECT_THAT(result.reason, HasSubstr("no path within 5000 checks"));
  EXPECT_LT(result.checks, 6000u);
}

TEST_F(Planning, a_cancelled_plan_ends_at_once) {
  int asked = 0;
  const Hooks hooks{[&] { return ++asked > 3; }, {}};
  const Result result = plan(robot_, world_, cost_, problem_, settings_, hooks);
  EXPECT_FALSE(result.solved);
  EXPECT_EQ(result.reason, "cancelled");
}

TEST_F(Planning, straight_is_the_line_or_a_reason) {
  problem_.straight = true;
  EXPECT_THAT(solve().reason, HasSubstr("straight line is blocked"));
  problem_.goals = {Vector3(-0.6, 0.5, 0)};
  const Result result = solve();
  expect_sound(result);
  EXPECT_EQ(result.path.size(), 2u);
}

TEST_F(Planning, beside_a_person_the_path_costs_less_than_the_shortest) {
  world_.set_scene({});
  cost_ = HumanCost(robot_, {1.0, 3.0, 1.0, 0.0, 0.0});
  put_person({1.5, 0, 0});
  problem_.start = Vector3(-1.2, 0, 0);
  problem_.goals = {Vector3(1.2, 0, 0)};
  ASSERT_TRUE(world_.check_motion(problem_.start, problem_.goals[0]).free);
  problem_.straight = true;
  const Result straight = solve();
  problem_.straight = false;
  std::vector<double> costs;
  for (problem_.seed = 1; problem_.seed < 10; ++problem_.seed) {
    const Result careful = solve();
    expect_sound(careful);
    EXPECT_LT(careful.cost, straight.cost);
    costs.push_back(careful.cost);
  }
  std::sort(costs.begin(), costs.end());
  EXPECT_LT(costs[4], 0.7 * straight.cost);
}

}  // namespace
}  // namespace handsel::path_planner::path_planner_test
