// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/live_path.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/trajectory/path/broken_line.hpp"
#include "tests/support/oracles/sound_path.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::path_planner::live_path_test {
namespace {

using ::testing::HasSubstr;

class LivePath : public ::testing::Test {
 protected:
  LivePath() {
    problem_.axes = {0, 1, 2};
    problem_.start = Vector3(-1.0, 0.3, 0.3);
    problem_.goals = {Vector3(1.0, 0.3, 0.3)};
    running_ = {problem_.start, problem_.goals[0]};
    base(1.1);
  }
  void base(double height) {
    world_.set_base(make_pose({0, 0, height}));
    cost_.set_base(make_pose({0, 0, height}));
  }
  void put_wall(const Vector3& at) {
    Scene scene;
    scene.boxes.push_back({"wall", make_pose(at), {0.1, 0.1, 0.4}, false});
    world_.set_scene(scene);
  }
  void put_person(const Vector3& feet) {
    const HumanState people = test::person_at(feet);
    world_.set_people(people);
    cost_.set_people(people);
  }
  ReplanResult go() {
    return continue_path({robot_, world_, cost_}, problem_, running_, settings_, live_, hooks_);
  }
  void expect_sound(const Result& result) { test::expect_sound(result, problem_, world_); }

  RobotModel robot_{test::planar_arm()};
  CollisionWorld world_{robot_, nullptr};
  HumanCost cost_{robot_, {}};
  Problem problem_;
  std::vector<Vector> running_;
  Settings settings_;
  ReplanSettings live_;
  Hooks hooks_;
};

TEST_F(LivePath, the_remainder_goes_on_from_where_the_arm_is) {
  const std::vector<Vector> path = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(1, 1, 0)};
  const auto rest = remainder(path, Vector3(0.5, 0.02, 0), 0.1);
  ASSERT_EQ(rest.size(), 3u);
  EXPECT_EQ(rest[0], Vector3(0.5, 0.02, 0));
  EXPECT_EQ(rest[1], path[1]);
  EXPECT_EQ(remainder(path, Vector3(1, 0.5, 0), 0.1).size(), 2u);
  EXPECT_TRUE(remainder(path, Vector3(0.5, 0.5, 0), 0.1).empty()) << "not on it";
  EXPECT_TRUE(remainder(path, path.back(), 0.1).empty()) << "at its end";
  EXPECT_TRUE(remainder(path, Vector::Zero(2), 0.1).empty()) << "another robot's";
  EXPECT_TRUE(remainder({}, Vector3(0, 0, 0), 0.1).empty());
}

TEST_F(LivePath, a_free_path_that_nobody_minds_is_kept) {
  const ReplanResult result = go();
  EXPECT_EQ(result.outcome, ReplanOutcome::kept);
  EXPECT_EQ(result.result.path, running_);
  EXPECT_EQ(result.before, result.after);
  expect_sound(result.result);
}

TEST_F(LivePath, what_came_into_it_is_led_around) {
  put_wall({0.95, 0.55, 1.1});
  ASSERT_TRUE(world_.check(problem_.start).free && world_.check(problem_.goals[0]).free);
  ASSERT_FALSE(world_.check_motion(running_[0], running_[1]).free);
  for (problem_.seed = 1; problem_.seed <= 20; ++problem_.seed) {
    const ReplanResult result = go();
    EXPECT_THAT(result.outcome,
                ::testing::AnyOf(ReplanOutcome::repaired, ReplanOutcome::replanned));
    EXPECT_EQ(result.before, std::numeric_limits<double>::infinity());
    expect_sound(result.result);
  }
}

TEST_F(LivePath, it_gets_cheaper_for_a_person_who_came) {
  put_person({1.7, 0.0, 0});
  running_ = {problem_.start, Vector3(-0.6, 0.9, -0.9), Vector3(0.2, 1.0, -0.6), problem_.goals[0]};
  int cheaper = 0;
  for (problem_.seed = 1; problem_.seed <= 10; ++problem_.seed) {
    std::vector<Vector> path = running_;
    double first = -1, last = 0;
    for (int k = 0; k < 5; ++k) {
      problem_.seed += 100;
      const ReplanResult result =
          continue_path({robot_, world_, cost_}, problem_, path, settings_, live_);
      if (result.outcome == ReplanOutcome::kept)
        EXPECT_EQ(result.after, result.before);
      else
        EXPECT_LT(result.after, result.before * (1 - live_.min_gain));
      expect_sound(result.result);
      if (first < 0) first = result.before;
      last = result.after;
      path = result.result.path;
    }
    problem_.seed -= 500;
    cheaper += last < 0.97 * first;
  }
  EXPECT_GE(cheaper, 9);
}

TEST_F(LivePath, a_new_goal_is_led_to_from_the_path) {
  problem_.goals = {Vector3(0.9, -0.6, 0.5), Vector3(1.2, 0.4, -0.2)};
  const ReplanResult result = go();
  EXPECT_EQ(result.outcome, ReplanOutcome::replanned);
  expect_sound(result.result);
}

TEST_F(LivePath, what_cannot_be_saved_is_planned_anew_and_what_cannot_be_planned_is_told) {
  put_wall({0.95, 0.55, 1.1});
  live_.tries = 0;
  const ReplanResult anew = go();
  EXPECT_EQ(anew.outcome, ReplanOutcome::replanned);
  expect_sound(anew.result);
  const double x = 0.4 * (std::cos(1.0) + std::cos(1.3) + std::cos(1.6)),
               y = 0.4 * (std::sin(1.0) + std::sin(1.3) + std::sin(1.6));
  put_wall({x, y, 1.1});
  const ReplanResult none = go();
  EXPECT_EQ(none.outcome, ReplanOutcome::blocked);
  EXPECT_FALSE(none.result.solved);
  EXPECT_THAT(none.result.reason, HasSubstr("box wall"));
}

TEST_F(LivePath, the_same_seed_gives_the_same_path) {
  put_wall({0.95, 0.55, 1.1});
  put_person({1.9, 0.0, 0});
  const ReplanResult first = go(), again = go();
  EXPECT_EQ(first.result.path, again.result.path);
  EXPECT_EQ(first.result.checks, again.result.checks);
}

TEST_F(LivePath, a_cancelled_one_ends_at_once) {
  put_wall({0.95, 0.55, 1.1});
  const ReplanResult whole = go();
  int asked = 0;
  hooks_.cancelled = [&asked] { return ++asked > 2; };
  const ReplanResult result = go();
  EXPECT_FALSE(result.result.solved);
  EXPECT_LT(result.result.checks, whole.result.checks);
  EXPECT_EQ(result.result.reason, "cancelled");
}

TEST_F(LivePath, bad_input_has_its_reason) {
  const auto reason = [this] { return go().result.reason; };
  problem_.start = Vector::Zero(2);
  EXPECT_THAT(reason(), HasSubstr("axes"));
  problem_.start = Vector3(-1.0, 0.3, 0.3);
  problem_.budget = 0;
  EXPECT_THAT(reason(), HasSubstr("time limit is zero"));
  problem_.budget = 1000;
  problem_.goals.clear();
  EXPECT_THAT(reason(), HasSubstr("no goal"));
  problem_.goals = {Vector::Zero(4)};
  EXPECT_THAT(reason(), HasSubstr("axes"));
  problem_.axes = {7};
  EXPECT_THAT(reason(), HasSubstr("axis 7"));
}

}  // namespace
}  // namespace handsel::path_planner::live_path_test
