// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/collision_checker/forecaster.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::collision_checker::collision_checker_test {
namespace {

using ::testing::HasSubstr;

/// The first axis from -1 to 1 rad at 0.5 rad/s.
ActiveTrajectory sweep(double time, double speed_factor) {
  ActiveTrajectory active;
  active.trajectory = 7;
  active.time = time;
  active.speed_factor = speed_factor;
  active.position = Vector3(-1 + 0.5 * time, 0, 0);
  active.axes = {0};
  active.rest.axes = {{{-1, 0.5, 0}, {{4.0, 0.0}}}};
  return active;
}

Scene wall(double angle) {
  Scene scene;
  scene.revision = 1;
  scene.boxes.push_back(
      {"wall", make_pose({std::cos(angle), std::sin(angle), 0}), {0.02, 0.02, 0.2}, false});
  return scene;
}

HumanState person(const Vector3& feet) {
  HumanState people;
  Person one;
  one.id = "anna";
  one.joints = standing_body(feet, M_PI, 1.75);
  people.people.push_back(one);
  return people;
}

class Forecast : public ::testing::Test {
 protected:
  RobotModel robot_{test::planar_arm()};
  Forecaster forecaster_{robot_, nullptr, {}, {}};
};

TEST_F(Forecast, sees_a_wall_within_the_horizon_and_says_when) {
  forecaster_.set_scene(wall(0.0));
  const TrajectoryForecast near = forecaster_.forecast(sweep(1.0, 1.0));
  EXPECT_TRUE(near.collides);
  EXPECT_EQ(near.trajectory, 7u);
  EXPECT_GT(near.time_to_collision, 0.75);
  EXPECT_LT(near.time_to_collision, 1.05);
  EXPECT_THAT(near.reason, HasSubstr("box wall"));
  const TrajectoryForecast far = forecaster_.forecast(sweep(0.0, 1.0));
  EXPECT_FALSE(far.collides);
  EXPECT_TRUE(std::isinf(far.time_to_collision));
  EXPECT_TRUE(std::isinf(far.clearance));
  EXPECT_EQ(far.cost, 0.0);
}

TEST_F(Forecast, time_counts_at_present_speed_and_a_held_trajectory_is_still_looked_at) {
  forecaster_.set_scene(wall(0.0));
  const double full = forecaster_.forecast(sweep(1.6, 1.0)).time_to_collision;
  EXPECT_NEAR(forecaster_.forecast(sweep(1.6, 0.5)).time_to_collision, 2 * full, 0.01);
  EXPECT_TRUE(forecaster_.forecast(sweep(1.7, 0.0)).collides);
}

TEST_F(Forecast, links_that_touch_and_stay_as_they_are_to_each_other_do_not_hold_the_motion) {
  ActiveTrajectory folded = sweep(0.0, 1.0);
  folded.position[1] = folded.position[2] = 2.9;  // link 1 and link 3 touch
  EXPECT_FALSE(forecaster_.forecast(folded).collides) << "only the first axis moves";
  folded.trajectory = 8;
  folded.axes = {1};
  folded.rest.axes = {{{2.9, -0.01, 0}, {{4.0, 0.0}}}};
  EXPECT_TRUE(forecaster_.forecast(folded).collides);
}

TEST(ForecastOfFingers, count_where_they_are_measured_not_where_they_are_commanded) {
  const std::shared_ptr<const RobotModel> robot = test::small_robot();
  Forecaster forecaster(*robot, nullptr, {}, {});
  ActiveTrajectory active;
  active.trajectory = 7;
  active.speed_factor = 1.0;
  active.position = Vector::Zero(robot->dof());  // finger_a straight ahead, into the box
  active.axes = {0};
  active.rest.axes = {{{0, 0.001, 0}, {{4.0, 0.0}}}};
  Scene scene;
  scene.boxes.push_back({"box", make_pose({0.87, 0.04, 1.0}), {0.04, 0.04, 0.04}, false});
  forecaster.set_scene(scene);
  EXPECT_TRUE(forecaster.forecast(active).collides) << "nothing is measured";
  scene.robot_known = true;
  scene.robot_position = active.position;
  scene.robot_position[robot->require_group("hand").axes.front()] = 1.4;
  forecaster.set_scene(scene);
  EXPECT_FALSE(forecaster.forecast(active).collides);
  std::swap(active.position, scene.robot_position);
  forecaster.set_scene(scene);
  EXPECT_TRUE(forecaster.forecast(active).collides);
}

TEST_F(Forecast, running_backward_looks_back) {
  forecaster_.set_scene(wall(0.0));
  EXPECT_FALSE(forecaster_.forecast(sweep(1.5, -1.0)).collides);
  EXPECT_TRUE(forecaster_.forecast(sweep(2.8, -1.0)).collides);
}

TEST_F(Forecast, notices_a_wall_that_appears_and_one_that_goes) {
  forecaster_.set_scene({});
  EXPECT_FALSE(forecaster_.forecast(sweep(1.0, 1.0)).collides);
  forecaster_.set_scene(wall(0.0));
  EXPECT_TRUE(forecaster_.forecast(sweep(1.0, 1.0)).collides);
  Scene gone;
  gone.revision = 2;
  forecaster_.set_scene(gone);
  EXPECT_FALSE(forecaster_.forecast(sweep(1.0, 1.0)).collides);
}

TEST_F(Forecast, judges_the_scene_once_a_state_while_nothing_changes) {
  forecaster_.set_scene(wall(0.9));
  forecaster_.forecast(sweep(0.5, 1.0));
  const std::uint64_t before = forecaster_.checks();
  forecaster_.forecast(sweep(0.5, 1.0));
  const std::uint64_t again = forecaster_.checks() - before;
  EXPECT_LE(again, 33u) << "people only";
}

TEST_F(Forecast, a_path_that_grows_while_it_runs_is_judged_anew) {
  forecaster_.set_scene(wall(0.0));
  ActiveTrajectory active = sweep(0.0, 1.0);
  for (AxisTrajectory& axis : active.rest.axes) axis.segments[0].duration = 1.2;
  EXPECT_FALSE(forecaster_.forecast(active).collides);
  active = sweep(1.0, 1.0);
  EXPECT_TRUE(forecaster_.forecast(active).collides)
      << "the same command, and what was put in line behind it";
}

TEST_F(Forecast, a_hand_counts_where_it_is_expected_when_the_robot_gets_there) {
  Scene scene;
  scene.robot_known = true;
  scene.T_world_base = make_pose({0, 0, 1.2});
  forecaster_.set_scene(scene);
  HumanState people = person({3, 0, 0});
  const ActiveTrajectory active = sweep(1.7, 1.0);  // it points to (1.1, 0) 0.3 s later
  forecaster_.set_people(people);
  const double stays = forecaster_.forecast(active).clearance;
  ASSERT_GT(stays, 1.0);
  const auto expected = [&](double first, double last) {
    people.people[0].hands = {{"r_hand", {}}};
    for (const double time : {0.1, 0.2, 0.3, 0.4, 0.5})
      people.people[0].hands[0].ahead.push_back(
          {time, time >= first && time <= last ? Vector3(1.1, 0, 1.2) : Vector3(3, 0, 1.2), 0.2});
    forecaster_.set_people(people);
    const TrajectoryForecast forecast = forecaster_.forecast(active);
    EXPECT_FALSE(forecast.collides) << "the guard answers for hands";
    return forecast.clearance;
  };
  EXPECT_LT(expected(0.3, 0.3), 0.0);
  EXPECT_GT(expected(0.5, 0.5), 0.02) << "the arm is past by then";
  EXPECT_NEAR(expected(0.6, 0.6), stays, 0.5);
}

TEST_F(Forecast, a_torso_in_the_way_is_a_collision_a_hand_only_lowers_the_clearance) {
  Scene scene;
  scene.robot_known = true;
  scene.T_world_base = make_pose({0, 0, 1.2});
  forecaster_.set_scene(scene);
  forecaster_.set_people(person({1.1, 0, 0}));
  const TrajectoryForecast torso = forecaster_.forecast(sweep(1.0, 1.0));
  EXPECT_TRUE(torso.collides);
  EXPECT_THAT(torso.reason, HasSubstr("person anna"));
  HumanState reaching = person({3, 0, 0});
  for (BodyJoint& joint : reaching.people[0].joints)
    if (joint.name == "r_hand" || joint.name == "r_wrist") joint.position = {1.1, 0, 1.2};
  forecaster_.set_people(reaching);
  const TrajectoryForecast hand = forecaster_.forecast(sweep(1.0, 1.0));
  EXPECT_FALSE(hand.collides);
  EXPECT_LT(hand.clearance, 0.0);
  EXPECT_GE(hand.cost, 0.0);
  EXPECT_LE(hand.cost, 1.0);
}

TEST_F(Forecast, another_robot_counts_where_it_is_when_the_arm_gets_there) {
  const ActiveTrajectory active = sweep(1.7, 1.0);  // the arm points along x 0.3 s later
  const auto forecast_with = [&](const Vector3& place, const Vector3& velocity) {
    HumanState around;
    around.robots.push_back(
        {"left",
         {{place - Vector3(0, 0, 0.3), place + Vector3(0, 0, 0.3), 0.03, velocity, velocity}},
         0});
    forecaster_.set_people(around);
    return forecaster_.forecast(active);
  };
  EXPECT_FALSE(forecast_with({1.0, 2, 0}, {0, 0, 0}).collides);
  const TrajectoryForecast coming = forecast_with({2.0, 0, 0}, {-3, 0, 0});
  EXPECT_TRUE(coming.collides) << "it comes 1 m nearer meanwhile";
  EXPECT_THAT(coming.reason, HasSubstr("robot left"));
  EXPECT_GT(coming.time_to_collision, 0.15);
  EXPECT_LT(coming.time_to_collision, 0.45);
  EXPECT_FALSE(forecast_with({1.0, 0, 0}, {3, 3, 0}).collides) << "it is gone by then";
}

TEST_F(Forecast, an_arm_that_is_too_near_to_another_robot_may_move_away) {
  const ActiveTrajectory active = sweep(1.0, 1.0);  // turns away from the object on the right
  HumanState around;
  const double angle = -0.5 - 0.06;
  const Vector3 beside(std::cos(angle), std::sin(angle), 0);
  around.robots.push_back({"left",
                           {{beside - Vector3(0, 0, 0.3), beside + Vector3(0, 0, 0.3), 0.05,
                             Vector3::Zero(), Vector3::Zero()}},
                           0});
  forecaster_.set_people(around);
  EXPECT_FALSE(forecaster_.forecast(active).collides);
}

TEST_F(Forecast, at_rest_reports_clearance_and_no_collision) {
  Scene scene = wall(0.0);
  forecaster_.set_scene(scene);
  forecaster_.set_people(person({3, 0, 0}));
  ActiveTrajectory rest;
  rest.position = Vector::Zero(3);
  const TrajectoryForecast forecast = forecaster_.forecast(rest);
  EXPECT_FALSE(forecast.collides);
  EXPECT_GT(forecast.clearance, 0.5);
  EXPECT_LT(forecast.clearance, 3.0);
  const std::uint64_t before = forecaster_.checks();
  forecaster_.forecast(rest);
  EXPECT_EQ(forecaster_.checks(), before);
}

TEST_F(Forecast, a_trajectory_for_another_robot_is_a_collision_now) {
  forecaster_.set_scene({});
  ActiveTrajectory wrong = sweep(1.0, 1.0);
  wrong.position = Vector::Zero(5);
  EXPECT_TRUE(forecaster_.forecast(wrong).collides);
  wrong = sweep(1.0, 1.0);
  wrong.axes = {9};
  EXPECT_TRUE(forecaster_.forecast(wrong).collides);
}

TEST_F(Forecast, the_end_of_the_trajectory_ends_the_look) {
  forecaster_.set_scene(wall(1.2));
  EXPECT_FALSE(forecaster_.forecast(sweep(3.8, 1.0)).collides);
  EXPECT_FALSE(forecaster_.forecast(sweep(4.0, 1.0)).collides);
}

TEST(Judge, answers_each_state_and_names_the_first_contact) {
  const RobotModel robot = test::planar_arm();
  CollisionWorld world(robot, nullptr);
  world.set_scene(wall(0.0));
  StateQuery query;
  query.id = {3, 4};
  query.states = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector::Zero(2)};
  const StateVerdict verdict = check_states(robot, world, query);
  EXPECT_EQ(verdict.id, query.id);
  EXPECT_EQ(verdict.free, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_THAT(verdict.reason, HasSubstr("box wall"));
  EXPECT_GT(verdict.clearance, 0.1);
  EXPECT_LT(verdict.clearance, 1.0);
}

}  // namespace
}  // namespace handsel::collision_checker::collision_checker_test
