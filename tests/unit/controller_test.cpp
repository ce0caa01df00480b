#include "components/trajectory_controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/trajectory_controller/gaze.hpp"
#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller {
namespace {

using test::ControllerBench;
using test::expect_smooth;
using test::goal;
using test::has;
using testing::HasSubstr;

TEST(Controller, sends_nothing_before_the_posture_is_known_and_then_holds_it) {
  ControllerBench b;
  b.robot_speaks = b.human_speaks = b.go_speaks = false;
  b.run(0.1);
  EXPECT_FALSE(b.ready);
  b.measured[1] = 0.3;
  b.robot_speaks = true;
  b.run(0.1);
  EXPECT_TRUE(b.ready);
  EXPECT_EQ(b.core.set_point().position[1], 0.3);
  EXPECT_EQ(b.core.mode(), Mode::hold);
  EXPECT_TRUE(has(b, Cause::human_state_silent));
  EXPECT_TRUE(has(b, Cause::no_go));
}

TEST(Controller, begins_inside_the_bounds_though_something_has_bent_a_finger_beyond_them) {
  ControllerBench b;
  const int bent = b.robot->require_group("hand").axes.front();
  const double lower = b.robot->axes()[static_cast<std::size_t>(bent)].lower;
  b.measured[bent] = lower - 0.03;
  b.run(0.1);
  ASSERT_TRUE(b.ready);
  EXPECT_EQ(b.core.set_point().position[bent], lower);
}

TEST(Controller, sends_nothing_after_a_sleep_until_it_knows_where_the_robot_has_stopped) {
  for (const bool stopped : {true, false}) {
    ControllerBench b;
    b.start();
    ASSERT_EQ(b.send(b.command(goal(), 1)), "");
    b.run(0.5);
    ASSERT_FALSE(b.at_rest());
    const Vector sent = b.core.set_point().position;
    b.now += std::chrono::milliseconds(1500);
    if (stopped) {
      b.drive = DriveMode::protective_stop;
      b.measured[0] += 0.2;
    }
    b.robot_speaks = false;
    b.run(0.05);
    EXPECT_FALSE(b.ready);
    b.robot_speaks = true;
    b.tick();
    b.tick();
    EXPECT_TRUE(b.ready);
    if (stopped) {
      EXPECT_EQ(b.core.set_point().position, b.measured);
      EXPECT_TRUE(b.at_rest());
    } else {
      EXPECT_LT((b.core.set_point().position - sent).norm(), 0.01) << "the robot side did not stop: goes on from what was sent last";
    }
  }
}

TEST(Controller, runs_a_trajectory_in_its_own_time_and_ends_exactly_there) {
  ControllerBench b;
  b.start();
  EXPECT_EQ(b.core.mode(), Mode::normal);
  const TrajectoryCommand c = b.command(goal(), 1);
  ASSERT_EQ(b.send(c), "");
  int steps = 0;
  while (b.core.status().motion == MotionState::running && steps < 20000) {
    b.tick();
    ++steps;
  }
  EXPECT_NEAR(steps * b.settings.period, c.trajectory.duration(), 0.003);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_EQ(b.core.status().progress, 1.0);
  EXPECT_TRUE(b.core.set_point().position.head(3).isApprox(goal(), 1e-9));
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.active().trajectory, 0u);
}

TEST(Controller, refuses_with_the_reason) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand good = b.command(goal(), 1);
  const auto refused = [&](TrajectoryCommand c, double age, const char* text) {
    EXPECT_THAT(b.send(c, age), HasSubstr(text));
    EXPECT_EQ(b.core.status().motion, MotionState::refused);
    EXPECT_EQ(b.core.status().trajectory, c.id);
    EXPECT_THAT(b.core.status().reason, HasSubstr(text));
  };
  TrajectoryCommand c = good;
  c.robot = "other";
  refused(c, 0, "robot other");
  c = good;
  c.epoch = 7;
  refused(c, 0, "epoch");
  refused(good, 2.0, "s old");
  c = good;
  c.axes = {0, 1};
  refused(c, 0, "names 2");
  c = good;
  c.axes = {0, 1, 99};
  refused(c, 0, "does not exist");
  c = good;
  c.axes = {0, 1, 1};
  refused(c, 0, "twice");
  c = good;
  c.axes = {0, 1, 3};
  refused(c, 0, "not moved by trajectories");
  c = good;
  c.trajectory.axes[1].segments[0].jerk *= 3;
  refused(c, 0, "");
  c = good;
  c.trajectory.axes[0].start.position += 0.2;
  refused(c, 0, "from the set-point");
  c = good;
  c.trajectory.axes[0].start.velocity = 0.1;
  refused(c, 0, "");
  c = good;
  c.trajectory = cut(good.trajectory, 0.0, 0.5 * good.trajectory.duration());
  refused(c, 0, "end at rest");
  c = b.command(ControllerBench::arm(0, 2.2, 0), 5);
  refused(c, 0, "outside its bounds");
  c = good;
  c.trajectory.axes[2].segments[0].duration = std::numeric_limits<double>::quiet_NaN();
  refused(c, 0, "");
  b.run(0.5);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.send(good), "");
}

TEST(Controller, the_same_command_twice_is_one) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand c = b.command(goal(), 1);
  ASSERT_EQ(b.send(c), "");
  b.run(0.5);
  EXPECT_THAT(b.send(c), HasSubstr("came before"));
  EXPECT_EQ(b.core.status().motion, MotionState::running);
  b.run(5);
  EXPECT_THAT(b.send(c), HasSubstr("came before"));
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(b.core.set_point().position.head(3).isApprox(goal(), 1e-9));
}

TEST(Controller, a_start_slightly_off_is_bridged_softly) {
  ControllerBench b;
  b.start();
  TrajectoryCommand c = b.command(goal(), 1);
  for (AxisTrajectory& axis : c.trajectory.axes) axis.start.position += 0.02;
  ASSERT_EQ(b.send(c), "");
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_NEAR(b.core.set_point().position[0], goal()[0] + 0.02, 1e-6);
  EXPECT_LE(b.worst_jerk, 1 + 1e-6);
  EXPECT_LE(b.worst_jump, 1 + 1e-6);
}

TEST(Controller, a_command_without_axes_stops_softly_along_the_path) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(0.8);
  TrajectoryCommand stop;
  stop.robot = "small";
  stop.id = 2;
  stop.epoch = 1;
  ASSERT_EQ(b.send(stop), "");
  b.run(1.5);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.status().motion, MotionState::stopped);
  EXPECT_EQ(b.core.active().trajectory, 0u);
  EXPECT_EQ(b.go_to(goal(), 3), "");
  b.run(5);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

struct Silence {
  const char* what;
  bool ControllerBench::*source;
  double within;  // detection
  Mode mode;
  Cause cause;
};

class SilentSource : public testing::TestWithParam<Silence> {};

TEST_P(SilentSource, brings_the_stated_mode_in_time_and_a_newer_go_resumes) {
  const Silence& s = GetParam();
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0.5, -0.5), 1), "");
  b.run(1.2);
  b.*s.source = false;
  b.run(s.within + 0.035);
  EXPECT_EQ(b.core.mode(), s.mode);
  EXPECT_TRUE(has(b, s.cause));
  b.run(1.2 + 0.05);
  EXPECT_EQ(b.at_rest(), s.mode >= Mode::hold);
  b.*s.source = true;
  b.run(0.5);
  if (s.mode < Mode::hold) return;
  EXPECT_EQ(b.core.mode(), Mode::hold);
  EXPECT_EQ(b.core.status().causes, bit(Cause::no_go));
  ++b.go.epoch;
  b.run(0.3);
  EXPECT_EQ(b.core.mode(), Mode::normal);
  b.run(6);
  EXPECT_EQ(b.core.status().motion, s.mode == Mode::hold ? MotionState::finished : MotionState::stopped);
  EXPECT_LE(b.worst_velocity, 1 + 1e-6);
  EXPECT_LE(b.worst_acceleration, 1 + 1e-6);
  EXPECT_LE(b.worst_jerk, 1 + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(table, SilentSource,
                         testing::Values(Silence{"robot", &ControllerBench::robot_speaks, 0.02, Mode::stop, Cause::robot_state_silent},
                                         Silence{"human", &ControllerBench::human_speaks, 0.2, Mode::stop, Cause::human_state_silent},
                                         Silence{"forecast", &ControllerBench::forecast_speaks, 0.1, Mode::hold, Cause::forecast_silent},
                                         Silence{"attention", &ControllerBench::attention_speaks, 0.3, Mode::slow,
                                                 Cause::attention_silent}),
                         [](const auto& p) { return std::string(p.param.what); });

TEST(Controller, silent_attention_means_a_fixed_low_speed) {
  ControllerBench b;
  b.attention_speaks = false;
  b.start();
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(1.0);
  EXPECT_NEAR(b.core.speed_factor(), b.settings.attention_lost_factor, 1e-9);
}

TEST(Controller, a_silent_supervisor_lets_the_trajectory_finish_and_then_holds) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(0.5);
  b.go_speaks = false;
  b.run(0.6);
  EXPECT_TRUE(has(b, Cause::supervisor_silent));
  EXPECT_LT(b.core.mode(), Mode::hold);
  EXPECT_NEAR(b.core.speed_factor(), 1.0, 1e-9);
  b.run(5);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_EQ(b.core.mode(), Mode::hold);
  b.go_speaks = true;
  b.run(0.5);
  EXPECT_EQ(b.core.mode(), Mode::hold);
  ++b.go.epoch;
  b.run(0.2);
  EXPECT_EQ(b.core.mode(), Mode::normal);
}

TEST(Controller, withdrawn_permission_holds_along_the_path_and_a_new_epoch_goes_on) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(0.8);
  b.go.allowed = false;
  b.run(1.5);
  EXPECT_EQ(b.core.mode(), Mode::hold);
  EXPECT_TRUE(b.at_rest());
  b.go.allowed = true;
  b.run(0.5);
  EXPECT_EQ(b.core.mode(), Mode::hold) << "the same epoch does not resume";
  ++b.go.epoch;
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

TEST(Controller, holding_along_the_path_takes_hardly_longer_than_the_fastest_stop) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(2.0, 0.0, 0.0), 1), "");
  b.run(1.5);
  const double speed = b.core.set_point().velocity[0];
  EXPECT_NEAR(speed, 0.5, 1e-6);
  b.go.allowed = false;
  b.core.on(b.go, b.now);
  int steps = 0;
  while (!b.at_rest() && steps < 5000) {
    b.tick();
    ++steps;
  }
  const KinematicLimits& g = b.robot->guard_limits();
  EXPECT_LT(steps * b.settings.period, 1.1 * stop_time(speed, g.acceleration[0], g.jerk[0]));
}

TEST(Controller, drive_off_stops_follows_the_robot_and_waits_for_permission) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(0.8);
  b.drive = DriveMode::protective_stop;
  b.run(1.2);
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_TRUE(has(b, Cause::drive_not_enabled));
  b.measured[0] += 0.1;
  b.run(3.0);
  EXPECT_NEAR(b.core.set_point().position[0], b.measured[0], 0.003);
  b.drive = DriveMode::enabled;
  b.run(0.2);
  EXPECT_EQ(b.core.mode(), Mode::hold);
  ++b.go.epoch;
  b.run(0.2);
  EXPECT_EQ(b.core.mode(), Mode::normal);
  EXPECT_LE(b.worst_jump, 1 + 1e-6);
}

TEST(Controller, a_robot_that_does_not_follow_is_a_fault_until_a_person_says_so) {
  ControllerBench b;
  b.start();
  b.follows = false;
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(3.5);
  EXPECT_EQ(b.core.mode(), Mode::fault);
  EXPECT_THAT(b.core.status().reason, HasSubstr("tracking_error"));
  b.run(3.0);
  ++b.go.epoch;
  b.run(0.3);
  EXPECT_EQ(b.core.mode(), Mode::fault) << "a new epoch alone is not enough";
  EXPECT_NE(b.go_to(goal(), 2), "");
  ++b.go.epoch;
  b.go.acknowledge = true;
  b.run(0.3);
  EXPECT_EQ(b.core.mode(), Mode::normal);
}

TEST(Controller, five_late_cycles_in_a_row_hold) {
  ControllerBench b;
  b.start();
  b.late = true;
  for (int k = 0; k < 4; ++k) b.tick();
  b.late = false;
  b.tick();
  EXPECT_EQ(b.core.mode(), Mode::normal);
  b.late = true;
  for (int k = 0; k < 5; ++k) b.tick();
  EXPECT_EQ(b.core.mode(), Mode::hold);
  EXPECT_TRUE(has(b, Cause::cycle_late));
  EXPECT_EQ(b.core.status().late_cycles, 9u);
}

TEST(Controller, a_collision_ahead_slows_and_then_holds_at_an_exchange_too) {
  for (const bool exchange : {false, true}) {
    SCOPED_TRACE(exchange);
    ControllerBench b;
    b.start();
    ActionStatus action;
    action.exchange_engaged = exchange;
    action.human = "anna";
    b.core.on(action, b.now);
    ASSERT_EQ(b.go_to(goal(), 4), "");
    b.forecast.trajectory = 4;
    b.forecast.collides = true;
    b.forecast.time_to_collision = 1.3;
    b.run(0.8);
    EXPECT_EQ(b.core.mode(), Mode::slow);
    EXPECT_NEAR(b.core.speed_factor(), 0.5, 0.02);
    b.forecast.time_to_collision = 0.3;
    b.run(1.2);
    EXPECT_EQ(b.core.mode(), Mode::hold);
    EXPECT_TRUE(b.at_rest());
  }
}

TEST(Controller, override_and_advice_combine_by_the_least) {
  ControllerBench b;
  b.start();
  b.go.override_factor = 0.6;
  b.advice.speed_factor = 0.4;
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(1.0);
  EXPECT_NEAR(b.core.speed_factor(), 0.4, 1e-6);
  b.advice.speed_factor = 1.0;
  b.run(1.0);
  EXPECT_NEAR(b.core.speed_factor(), 0.6, 1e-6);
}

TEST(Controller, recoils_along_the_path_when_advised_and_goes_on_later) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(1.2);
  const double there = b.core.set_point().position[0];
  b.advice.speed_factor = -1.0;
  b.run(1.5);
  EXPECT_NEAR(b.core.speed_factor(), -b.settings.recoil_limit, 1e-6);
  EXPECT_LT(b.core.set_point().position[0], there + 0.2);
  const double later = b.core.set_point().position[0];
  b.run(0.5);
  EXPECT_LT(b.core.set_point().position[0], later);
  b.run(10);
  EXPECT_TRUE(b.at_rest()) << "at the beginning of the path there is nowhere to go";
  b.advice.speed_factor = 1.0;
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_LE(b.worst_jerk, 1 + 1e-6);
}

TEST(Controller, a_person_standing_by_does_not_slow_and_one_in_the_way_does) {
  ControllerBench b;
  b.people.people = {b.standing(1.9, 0.0)};
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(0.8, 0.0, 0.0), 1), "");
  b.run(1.0);
  EXPECT_NEAR(b.core.speed_factor(), 1.0, 1e-9);
  b.run(4);
  b.people.people = {b.standing(0.75, -0.15)};
  ASSERT_EQ(b.go_to(ControllerBench::arm(-0.3, 0.0, 0.0), 2), "");
  b.run(4.0);
  EXPECT_LT(b.core.speed_factor(), 0.2);
  EXPECT_TRUE(has(b, Cause::separation));
  EXPECT_GT(b.core.guard_verdict().distance, 0.0);
  const ExecutionStatus near = b.core.status();
  EXPECT_GT(near.separation, 0.0);
  EXPECT_LT(near.separation, 0.75);
  EXPECT_GT(near.separation_limit, 0.0);
  EXPECT_GT((near.nearest_on_robot - near.nearest_on_person).norm(), near.separation);
  b.people.people.clear();
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

TEST(Controller, a_push_on_the_moving_arm_stops_it_and_a_load_does_not) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.2, 0.4, -0.5), 1), "");
  b.run(1.0);
  for (int k = 0; k < 500; ++k) {
    b.external_torque[1] = 20.0 * std::min(1.0, k * 0.002);  // a load taken up
    b.tick();
  }
  EXPECT_EQ(b.core.mode(), Mode::normal);
  b.external_torque[1] += 35.0;
  b.run(0.04);
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_THAT(b.core.status().reason, HasSubstr("contact: felt by shoulder"));
  EXPECT_TRUE(has(b, Cause::contact));
  EXPECT_FALSE(has(b, Cause::separation));
  b.external_torque[1] -= 35.0;
  b.run(1.0);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.mode(), Mode::hold);
}

TEST(Controller, a_push_at_rest_moves_the_arm_along_and_its_end_stops_it) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  b.external_torque[0] = 25.0;
  b.run(0.8);
  const double pushed = b.core.set_point().position[0];
  EXPECT_GT(pushed, 0.03);
  EXPECT_LT(b.core.mode(), Mode::stop);
  EXPECT_EQ(b.core.set_point().position[1], 0.0) << "only the axis that is pushed";
  b.external_torque[0] = 0.0;
  b.run(0.6);
  EXPECT_TRUE(b.at_rest());
  const double rested = b.core.set_point().position[0];
  b.external_torque[0] = -40.0;
  b.run(0.8);
  EXPECT_LT(b.core.set_point().position[0], rested - 0.03);
  b.run(2.0);
  EXPECT_GE(b.core.set_point().position[0], rested - b.settings.yield_reach - 1e-9);
  b.run(3.0);
  EXPECT_TRUE(b.at_rest()) << "a push without end is a load";
  expect_smooth(b);
  b.external_torque[0] = 0.0;
  b.run(5.0);
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

TEST(Controller, after_a_contact_the_arm_gives_way_to_who_is_pressed) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0, 0), 1), "");
  b.run(1.5);
  b.external_torque[0] = -40.0;
  b.run(0.8);
  EXPECT_GE(b.core.mode(), Mode::hold);
  const double stopped = b.core.set_point().position[0];
  b.run(0.5);
  EXPECT_LT(b.core.set_point().position[0], stopped - 0.03);
  b.external_torque[0] = 0.0;
  b.run(1.5);
  EXPECT_TRUE(b.at_rest());
  const double left = b.core.set_point().position[0];
  b.run(1.0);
  EXPECT_EQ(b.core.set_point().position[0], left) << "nor does it come after them";
  expect_smooth(b);
}

TEST(Controller, a_wall_ahead_is_named_and_kept) {
  ControllerSettings s;
  s.walls = {Wall{-Vector3::UnitY(), -0.5}};
  ControllerBench b(s);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0, 0), 1), "");
  bool named = false;
  for (int k = 0; k < 6000; ++k) {
    b.tick();
    named = named || has(b, Cause::wall);
    ASSERT_FALSE(has(b, Cause::separation));
  }
  EXPECT_TRUE(named);
  EXPECT_TRUE(b.core.set_point().velocity.cwiseAbs().maxCoeff() < 0.02);
  std::vector<Pose> links;
  b.robot->forward(b.core.set_point().position, links);
  EXPECT_LT((links[static_cast<std::size_t>(b.robot->link_index("lower"))] * Vector3(0.4, 0, 0)).y(), 0.5);
}

TEST(Controller, an_override_of_a_tenth_runs_everything_at_a_tenth) {
  ControllerBench b;
  b.go.override_factor = 0.1;
  b.start();
  const TrajectoryCommand c = b.command(goal(), 1);
  ASSERT_EQ(b.send(c), "");
  double fastest = 0.0;
  int steps = 0;
  while (b.core.status().motion == MotionState::running && steps < 200000) {
    b.tick();
    ++steps;
    fastest = std::max(fastest,
                       (b.core.set_point().velocity.head(3).array() / b.robot->comfort_limits().velocity.head(3).array()).abs().maxCoeff());
  }
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_LE(fastest, 0.1 + 1e-9);
  EXPECT_NEAR(steps * b.settings.period, 10.0 * c.trajectory.duration(), 0.05);
  EXPECT_TRUE(b.core.set_point().position.head(3).isApprox(goal(), 1e-9));
}

TEST(Controller, a_dry_run_computes_everything_and_begins_again_where_the_robot_stands) {
  ControllerSettings s;
  s.dry_run = true;
  ControllerBench b(s);
  b.follows = false;
  b.start();
  EXPECT_THAT(b.core.status().reason, HasSubstr("dry run"));
  ASSERT_EQ(b.go_to(goal(), 1), "");
  for (int k = 0; k < 20000 && b.core.status().motion == MotionState::running; ++k) b.tick();
  EXPECT_EQ(b.core.status().motion, MotionState::finished) << "a robot that does not follow is no fault here";
  EXPECT_TRUE(b.core.set_point().position.head(3).isApprox(goal(), 1e-9));
  b.run(5);
  EXPECT_TRUE(b.core.set_point().position.head(3).isZero(0.003));
  EXPECT_LT(b.core.mode(), Mode::hold);
  EXPECT_EQ(b.go_to(goal(), 2), "");
  expect_smooth(b);
}

TEST(Controller, hand_and_head_stop_with_the_arm_and_keep_the_same_limits) {
  ControllerBench b;
  b.start();
  const auto hand_to = [&](double x, std::uint64_t id) {
    HandCommand c;
    c.robot = "small";
    c.id = id;
    c.epoch = b.go.epoch;
    c.position = Vector::Constant(2, x);
    return b.core.accept(c, Duration(0), b.now);
  };
  ASSERT_EQ(hand_to(1.3, 1), "");
  b.advice.has_gaze_target = true;
  b.advice.gaze_target = Vector3(-1.0, 1.0, 1.0);
  b.run(0.25);
  EXPECT_GT(b.core.set_point().velocity[3], 0.5);
  EXPECT_GT(b.core.set_point().velocity[5], 0.5);
  b.human_speaks = false;
  b.run(0.2 + 0.34);
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_TRUE(b.core.set_point().velocity.isZero(0.0)) << "hand and head too";
  EXPECT_THAT(hand_to(0.2, 2), HasSubstr("mode stop"));
  b.human_speaks = true;
  b.run(0.2);
  ++b.go.epoch;
  b.run(3.0);
  // A slow grasp asked for in the middle of a fast opening, again and again.
  std::uint64_t id = 10;
  for (int k = 0; k < 60; ++k) {
    HandCommand c;
    c.robot = "small";
    c.id = ++id;
    c.epoch = b.go.epoch;
    c.action = k % 2 ? HandAction::grasp : HandAction::move;
    c.position = Vector::Constant(2, k % 4 < 2 ? 1.3 : -0.1);
    c.position[1] = k % 3 ? 0.01 * k : 1.2;
    ASSERT_EQ(b.core.accept(c, Duration(0), b.now), "");
    b.run(0.01 * (k % 23));
    ASSERT_FALSE(has(b, Cause::limit_violation)) << k;
  }
  expect_smooth(b);
}

TEST(Controller, the_payload_is_told_from_grasp_to_release) {
  ControllerBench b;
  b.start();
  EXPECT_EQ(b.core.payload(), 0.0);
  HandCommand c;
  c.robot = "small";
  c.id = 1;
  c.epoch = 1;
  c.action = HandAction::grasp;
  c.position = Vector::Constant(2, 0.6);
  c.payload = 0.35;
  const auto run = [&] {
    ASSERT_EQ(b.core.accept(c, Duration(0), b.now), "");
    for (int k = 0; k < 5000 && (k == 0 || b.core.status().hand == HandState::moving); ++k) b.tick();
    ++c.id;
  };
  b.external_torque = Vector::Zero(b.robot->dof());
  b.external_torque.segment(3, 2).setConstant(-0.5);  // something is between the fingers
  run();
  ASSERT_EQ(b.core.status().hand, HandState::grasped);
  EXPECT_EQ(b.core.payload(), 0.35);
  c.payload = 0.0;  // tighter, by who does not know what it is
  run();
  EXPECT_EQ(b.core.payload(), 0.35);
  b.external_torque.setZero();
  c.action = HandAction::release;
  c.position = Vector::Zero(2);
  run();
  EXPECT_EQ(b.core.status().hand, HandState::released);
  EXPECT_EQ(b.core.payload(), 0.0);
}

TEST(Controller, hand_commands_are_judged_like_trajectories) {
  ControllerBench b;
  b.start();
  HandCommand c;
  c.robot = "small";
  c.id = 9;
  c.epoch = 1;
  c.position = Vector::Constant(2, 0.5);
  HandCommand wrong = c;
  wrong.epoch = 3;
  EXPECT_THAT(b.core.accept(wrong, Duration(0), b.now), HasSubstr("epoch"));
  EXPECT_EQ(b.core.status().hand, HandState::refused);
  EXPECT_EQ(b.core.accept(c, Duration(0), b.now), "");
  EXPECT_EQ(b.core.status().hand, HandState::moving);
  EXPECT_EQ(b.core.status().hand_command, 9u);
  b.run(1.0);
  EXPECT_EQ(b.core.status().hand, HandState::idle);
  EXPECT_NEAR(b.core.set_point().position[3], 0.5, 1e-9);
  EXPECT_EQ(b.core.accept(c, Duration(0), b.now), "") << "the same id again is no new motion";
  EXPECT_EQ(b.core.status().hand, HandState::idle);
}

TEST(Controller, the_head_turns_to_what_attention_looks_at) {
  for (const bool arm_runs : {false, true}) {
    ControllerBench b;
    b.start();
    if (arm_runs) {
      ASSERT_EQ(b.send(b.command(goal(), 1)), "");
    }
    b.run(0.2);
    b.advice.has_gaze_target = true;
    b.advice.gaze_target = Vector3(1.0, 1.0, 1.0);
    b.run(2.0);
    EXPECT_NEAR(b.core.set_point().position[5], M_PI / 4, 0.04);
    EXPECT_NEAR(b.core.set_point().position[6], std::atan2(-0.3, std::sqrt(2.0)), 0.04);
    EXPECT_LE(b.worst_jerk, 1 + 1e-6);
    b.run(10.0);
    EXPECT_TRUE(!arm_runs || b.core.set_point().position.head(3).isApprox(goal(), 1e-9));
  }
}

TEST(Gaze, stays_inside_the_bounds_for_points_out_of_view) {
  const auto robot = test::small_robot();
  const std::vector<double> q = aim(*robot, robot->require_group("head"), Vector::Zero(robot->dof()), Vector3(0.2, 0, 5.0));
  EXPECT_LE(q[1], 0.5 + 1e-12);
  EXPECT_GE(q[1], -0.7 - 1e-12);
}

/// The forearm has just passed in front of the camera: nodding on to who sits there would push the camera into it.
TEST(HeadRoom, the_head_does_not_turn_into_the_arm) {
  const RobotModel robot = RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  HeadRoom room(robot);
  Vector q = robot.rest_posture();
  q.head(7) << -0.286, 1.673, -0.285, -1.170, -1.204, 1.639, -1.292;
  const std::vector<int>& head = robot.require_group("head").axes;
  q[head[0]] = 0.001;
  q[head[1]] = 0.127;
  EXPECT_FALSE(room.lets_turn(q, {0.115, -0.515}));
  EXPECT_FALSE(room.lets_turn(q, {0.115, -0.70}));
  q[head[0]] = 0.115;
  q[head[1]] = -0.515;
  ASSERT_LT(room.clearance(q), 0.02);
  EXPECT_TRUE(room.lets_turn(q, {0.115, 0.127})) << "away from the arm it always may";
  Vector away = q;
  away.head(7) = robot.rest_posture().head(7);
  EXPECT_TRUE(room.lets_turn(away, {-1.0, -0.7})) << "nothing is there";
}

TEST(Controller, settings_out_of_range_are_refused_by_name) {
  ControllerSettings s;
  s.period = 0.0;
  EXPECT_THROW(Controller(s, test::small_robot()), ConfigError);
}

}  // namespace
}  // namespace handsel::trajectory_controller
