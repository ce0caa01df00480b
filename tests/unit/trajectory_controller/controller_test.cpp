// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_test {
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
      EXPECT_LT((b.core.set_point().position - sent).norm(), 0.01)
          << "the robot side did not stop: goes on from what was sent last";
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
  ControllerSettings slow_back;
  slow_back.recoil_limit = 0.2;
  ControllerBench b(slow_back);
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
  b.people.people = {b.standing(2.6, 0.0)};
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
  EXPECT_GT(b.core.status().separation, 0.0);
  const ExecutionStatus near = b.core.status();
  EXPECT_GT(near.separation, 0.0);
  EXPECT_LT(near.separation, 0.75);
  EXPECT_GT(near.separation_limit, 0.0);
  EXPECT_GT((near.nearest_on_robot - near.nearest_on_person).norm(), near.separation);
  b.people.people.clear();
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
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
  EXPECT_LT(
      (links[static_cast<std::size_t>(b.robot->link_index("lower"))] * Vector3(0.4, 0, 0)).y(),
      0.5);
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
    fastest = std::max(fastest, (b.core.set_point().velocity.head(3).array() /
                                 b.robot->comfort_limits().velocity.head(3).array())
                                    .abs()
                                    .maxCoeff());
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
  EXPECT_EQ(b.core.status().motion, MotionState::finished)
      << "a robot that does not follow is no fault here";
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
  // Repeatedly commands a slow grasp in the middle of a fast opening.
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
  EXPECT_EQ(b.core.hands().payload(), 0.0);
  HandCommand c;
  c.robot = "small";
  c.id = 1;
  c.epoch = 1;
  c.action = HandAction::grasp;
  c.position = Vector::Constant(2, 0.6);
  c.payload = 0.35;
  const auto run = [&] {
    ASSERT_EQ(b.core.accept(c, Duration(0), b.now), "");
    for (int k = 0; k < 5000 && (k == 0 || b.core.status().hand == HandState::moving); ++k)
      b.tick();
    ++c.id;
  };
  b.external_torque = Vector::Zero(b.robot->dof());
  b.external_torque.segment(3, 2).setConstant(-0.5);  // an object between the fingers
  run();
  ASSERT_EQ(b.core.status().hand, HandState::grasped);
  EXPECT_EQ(b.core.hands().payload(), 0.35);
  c.payload = 0.0;  // tighter, from a sender that does not know the load
  run();
  EXPECT_EQ(b.core.hands().payload(), 0.35);
  b.external_torque.setZero();
  c.action = HandAction::release;
  c.position = Vector::Zero(2);
  run();
  EXPECT_EQ(b.core.status().hand, HandState::released);
  EXPECT_EQ(b.core.hands().payload(), 0.0);
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

TEST(Controller, settings_out_of_range_are_refused_by_name) {
  ControllerSettings s;
  s.period = 0.0;
  EXPECT_THROW(Controller(s, test::small_robot()), ConfigError);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_test
