// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <gtest/gtest.h>

#include "components/path_planner/path_planner.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel::path_planner::path_planner_property_test {
namespace {

constexpr unsigned kSeed = 4242;

TEST(PathPlannerProperty, paths_in_random_scenes_are_free_within_limits_and_repeatable) {
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> place(-1.1, 1.1), size(0.05, 0.25), angle(-2.8, 2.8);
  const RobotModel robot = test::planar_arm();
  int solved = 0, possible = 0;
  for (int k = 0; k < 60; ++k) {
    CollisionWorld world(robot, nullptr);
    HumanCost cost(robot, {});
    Scene scene;
    for (int i = 0; i < 5; ++i)
      scene.boxes.push_back({"box" + std::to_string(i),
                             make_pose({place(random), place(random), 0}),
                             {size(random), size(random), 0.2},
                             false});
    world.set_scene(scene);
    if (k % 2 == 1) {
      HumanState people;
      Person person;
      person.joints = standing_body({2.5 * place(random), 1.6, 0}, -1.5, 1.75);
      people.people.push_back(person);
      world.set_people(people);
      cost.set_people(people);
      cost.set_base(make_pose({0, 0, 0.0}));
    }
    Problem problem;
    problem.axes = {0, 1, 2};
    problem.seed = kSeed + k;
    problem.budget = 60000;
    problem.start = Vector3(angle(random), angle(random), angle(random));
    problem.goals = {Vector3(angle(random), angle(random), angle(random))};
    if (!world.check(problem.start).free || !world.check(problem.goals[0]).free) continue;
    ++possible;
    const Result result = plan(robot, world, cost, problem, {});
    if (!result.solved) {
      EXPECT_FALSE(result.reason.empty());
      continue;
    }
    ++solved;
    Scene shrunk = scene;
    for (SceneBox& box : shrunk.boxes) box.size -= Vector3::Constant(0.004);
    CollisionWorld inner(robot, nullptr);
    inner.set_scene(shrunk);
    for (std::size_t i = 1; i < result.path.size(); ++i) {
      ASSERT_TRUE(world.check_motion(result.path[i - 1], result.path[i], 0.002).free)
          << "case " << k;
      ASSERT_TRUE(inner.check_motion(result.path[i - 1], result.path[i], 0.0003).free)
          << "deeper than 2 mm, case " << k;
      for (int axis = 0; axis < 3; ++axis) ASSERT_LE(std::abs(result.path[i][axis]), 2.9 + 1e-9);
    }
    EXPECT_EQ(plan(robot, world, cost, problem, {}).path, result.path) << "case " << k;
  }
  std::printf("%d of %d solved, seed %u\n", solved, possible, kSeed);
  EXPECT_GT(possible, 15);
  EXPECT_GE(solved, possible * 8 / 10);
}

}  // namespace
}  // namespace handsel::path_planner::path_planner_property_test
