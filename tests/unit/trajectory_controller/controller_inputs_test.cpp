// SPDX-License-Identifier: Apache-2.0
// Inputs and reports of the controller: each part alone.
#include <gtest/gtest.h>

#include <limits>

#include "components/trajectory_controller/input/inputs.hpp"
#include "components/trajectory_controller/output/command_report.hpp"
#include "components/trajectory_controller/supervise/speed_limit.hpp"
#include "components/trajectory_controller/supervise/tracking_monitor.hpp"

namespace handsel::trajectory_controller::controller_inputs_test {
namespace {

TimePoint at(double seconds) { return TimePoint{from_seconds(seconds)}; }

TEST(SampleTime, an_older_sample_does_not_turn_it_back) {
  SampleTime time;
  EXPECT_EQ(time.age(at(2.0)), -1.0);
  time.mark(at(1.0));
  time.mark(at(0.5));
  EXPECT_DOUBLE_EQ(time.age(at(1.25)), 0.25);
  EXPECT_EQ(time.age(at(0.5)), 0.0);
}

RobotState state_of(DriveMode mode, std::uint64_t sequence) {
  RobotState state;
  state.mode = mode;
  state.sequence = sequence;
  return state;
}

TEST(RobotInput, set_points_begin_anew_at_another_robot_side_only) {
  RobotInput side;
  EXPECT_FALSE(side.ready());
  EXPECT_TRUE(side.set(state_of(DriveMode::enabled, 5), at(1.0), {}, false));
  EXPECT_FALSE(side.set(state_of(DriveMode::enabled, 6), at(1.002), {}, false));
  EXPECT_TRUE(side.set(state_of(DriveMode::enabled, 7), at(1.004), {}, true)) << "another writer";
  EXPECT_FALSE(side.set(state_of(DriveMode::enabled, 1), at(1.006), {}, false));
  EXPECT_TRUE(side.set(state_of(DriveMode::enabled, 0), at(1.6), {}, false)) << "after silence";
}

TEST(RobotInput, nothing_is_sent_after_a_sleep_until_a_fresh_state_arrives) {
  RobotInput side;
  side.set(state_of(DriveMode::enabled, 1), at(1.0), {}, false);
  side.begin_cycle(at(1.0));
  EXPECT_TRUE(side.may_send(at(1.0), true));
  side.begin_cycle(at(1.2));
  EXPECT_FALSE(side.may_send(at(1.2), true));
  side.set(state_of(DriveMode::enabled, 2), at(1.2), from_seconds(0.1), false);
  EXPECT_FALSE(side.may_send(at(1.2), true)) << "a state that waited meanwhile";
  side.set(state_of(DriveMode::enabled, 3), at(1.201), {}, false);
  EXPECT_TRUE(side.may_send(at(1.201), true));
}

TEST(ObservedPeople, the_only_person_is_the_partner_until_the_handover_ends) {
  ObservedPeople people(0.25);
  HumanState sample;
  sample.people.resize(1);
  sample.people[0].id = "anna";
  people.set(sample, at(1.0));
  ActionStatus action;
  action.exchange_engaged = true;
  people.set(action);
  EXPECT_EQ(people.partner(), "anna");
  people.end_exemption();
  EXPECT_EQ(people.partner(), "anna") << "still engaged";
  action.exchange_engaged = false;
  people.set(action);
  people.end_exemption();
  EXPECT_EQ(people.partner(), "");
}

TEST(MotionPermission, an_override_that_is_no_number_permits_no_speed) {
  MotionPermission permission;
  Go go;
  go.state_revision = 1;
  go.override_factor = std::numeric_limits<double>::quiet_NaN();
  permission.set(go, at(1.0));
  EXPECT_EQ(permission.go().override_factor, 0.0);
  go.override_factor = 3.0;
  permission.set(go, at(1.1));
  EXPECT_EQ(permission.go().override_factor, 1.0);
}

TEST(MotionPermission, an_older_epoch_is_no_sign_of_life) {
  MotionPermission permission;
  Go go;
  go.state_revision = 1;
  go.epoch = 2;
  permission.set(go, at(1.0));
  go.epoch = 1;
  permission.set(go, at(5.0));
  EXPECT_DOUBLE_EQ(permission.age(at(5.0)), 4.0);
  EXPECT_NE(permission.reason(), "");
}

TEST(CommandReport, a_refusal_is_shown_for_its_cycles_and_then_forgotten) {
  CommandReport report;
  report.accept(3);
  report.refuse(4, "too far", 2);
  EXPECT_EQ(report.trajectory(), 4u);
  EXPECT_EQ(report.reason(), "trajectory 4: too far");
  report.step();
  EXPECT_TRUE(report.refused());
  report.step();
  EXPECT_FALSE(report.refused());
  EXPECT_EQ(report.trajectory(), 3u);
  EXPECT_EQ(report.reason(), "");
}

TEST(CommandReport, a_refusal_at_rest_lasts_until_a_trajectory_is_accepted) {
  CommandReport report;
  report.refuse(4, "too far", 0);
  for (int k = 0; k < 1000; ++k) report.step();
  EXPECT_TRUE(report.refused());
  report.accept(5);
  EXPECT_FALSE(report.refused());
  EXPECT_TRUE(report.accepted(5));
  EXPECT_FALSE(CommandReport().accepted(0));
}

class SpeedLimitTest : public testing::Test {
 protected:
  SpeedLimitTest() {
    inputs_.advice.set({}, at(1.0));
    Go go;
    go.state_revision = 1;
    inputs_.permission.set(go, at(1.0));
  }
  double wanted(double now = 1.0) { return wanted_factor(settings_, inputs_, 7, guard_, at(now)); }

  SpeedSettings settings_;
  Inputs inputs_{{}, ObservedPeople(0.25), {}, {}, {}};
  GuardVerdict guard_;
};

TEST_F(SpeedLimitTest, the_strictest_limit_counts) {
  EXPECT_EQ(wanted(), 1.0);
  guard_.forward = 0.6;
  EXPECT_EQ(wanted(), 0.6);
  inputs_.advice.value.speed_factor = 0.4;
  EXPECT_EQ(wanted(), 0.4);
  EXPECT_EQ(wanted(2.0), 0.2) << "attention is silent";
}

TEST_F(SpeedLimitTest, recoil_is_limited_by_the_guard_and_the_settings) {
  settings_.recoil_limit = 0.2;
  inputs_.advice.value.speed_factor = -1.0;
  EXPECT_EQ(wanted(), -0.2);
  guard_.backward = -0.1;
  EXPECT_EQ(wanted(), -0.1);
}

TEST_F(SpeedLimitTest, a_forecast_of_another_trajectory_does_not_count) {
  TrajectoryForecast forecast;
  forecast.trajectory = 8;
  forecast.collides = true;
  forecast.time_to_collision = 1.3;
  inputs_.forecast.set(forecast, at(1.0));
  EXPECT_EQ(wanted(), 1.0);
  inputs_.forecast.value.trajectory = 7;
  EXPECT_DOUBLE_EQ(wanted(), 0.5);
}

TEST_F(SpeedLimitTest, the_cost_ahead_slows_but_in_a_handover) {
  inputs_.forecast.value.trajectory = 7;
  inputs_.forecast.value.cost = 1.0;
  EXPECT_DOUBLE_EQ(wanted(), 0.4);
  ActionStatus action;
  action.exchange_engaged = true;
  action.human = "anna";
  inputs_.people.set(action);
  EXPECT_EQ(wanted(), 1.0);
}

TEST(TrackingMonitor, an_error_that_lasts_is_one_and_names_the_axis) {
  TrackingMonitor monitor(0.3, 0.1);
  const Eigen::Vector3d measured(0.0, 0.5, 0.0), set_point(0.1, 0.0, 0.0);
  EXPECT_FALSE(monitor.update({0, 1, 2}, measured, set_point, true, 0.08));
  EXPECT_FALSE(monitor.update({0, 1, 2}, measured, set_point, false, 0.08)) << "follows nothing";
  EXPECT_FALSE(monitor.update({0, 1, 2}, measured, set_point, true, 0.08));
  EXPECT_EQ(monitor.axis(), -1);
  EXPECT_TRUE(monitor.update({0, 1, 2}, measured, set_point, true, 0.08));
  EXPECT_EQ(monitor.axis(), 1);
  EXPECT_DOUBLE_EQ(monitor.distance(), 0.5);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_inputs_test
