// SPDX-License-Identifier: Apache-2.0
// Successive trajectories: joined in motion, queued, refused.
#include "components/trajectory_controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_queue_test {
namespace {

using test::ControllerBench;
using test::expect_smooth;
using test::goal;
using testing::HasSubstr;

TEST(Controller, goes_over_to_another_trajectory_while_moving) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0.5, -0.5), 1), "");
  b.run(1.2);
  const double speed = b.core.set_point().velocity[0];
  EXPECT_GT(speed, 0.4);
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.4, -0.4, 0.3), 2), "");
  EXPECT_EQ(b.core.status().motion, MotionState::running);
  EXPECT_EQ(b.core.status().trajectory, 2u);
  double slowest = speed;
  for (int k = 0; k < 300; ++k) {
    b.tick();
    slowest = std::min(slowest, b.core.set_point().velocity[0]);
    const ActiveTrajectory a = b.core.active();
    ASSERT_NEAR(a.rest.at(a.time).position[0], b.core.set_point().position[0], 1e-9);
  }
  EXPECT_GT(slowest, 0.6 * speed) << "no stop between";
  EXPECT_EQ(b.core.active().trajectory, 2u);
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(
      b.core.set_point().position.head(3).isApprox(ControllerBench::arm(1.4, -0.4, 0.3), 1e-6));
  expect_smooth(b);
}

TEST(Controller, turns_round_for_another_trajectory_while_running_back) {
  ControllerSettings slow_back;
  slow_back.recoil_limit = 0.2;
  ControllerBench b(slow_back);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0.5, -0.5), 1), "");
  b.run(2.0);
  b.advice.speed_factor = -1.0;
  b.run(1.5);
  ASSERT_LT(b.core.speed_factor(), -0.1);
  ASSERT_EQ(b.go_to(ControllerBench::arm(-0.5, 0.2, 0.1), 2), "");
  b.advice.speed_factor = 1.0;
  b.run(8);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(
      b.core.set_point().position.head(3).isApprox(ControllerBench::arm(-0.5, 0.2, 0.1), 1e-6));
  expect_smooth(b);
}

TEST(Controller, what_comes_late_in_a_stop_on_the_path_goes_on_from_there) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0.5, -0.5), 1), "");
  b.run(1.5);
  b.go.allowed = false;
  b.run(0.35);
  ASSERT_FALSE(b.at_rest());
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.2, 0.0, 0.0), 2), "")
      << "Hold forbids motion, not plans";
  b.run(1.5);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.status().motion, MotionState::running);
  b.go.allowed = true;
  ++b.go.epoch;
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(
      b.core.set_point().position.head(3).isApprox(ControllerBench::arm(1.2, 0.0, 0.0), 1e-6));
  expect_smooth(b);
}

/// From where the one before is left: planned for the moment of the switch, with its velocity and
/// acceleration.
TrajectoryCommand planned_for_a_switch(const ControllerBench& b, const TrajectoryCommand& before,
                                       double at, const Vector& goal, std::uint64_t id) {
  const KinematicLimits& l = b.robot->comfort_limits();
  TrajectoryCommand c = before;
  c.id = id;
  c.trajectory = solve(before.trajectory.at(at), rest_state(goal),
                       {l.velocity.head(3), l.acceleration.head(3), l.jerk.head(3)})
                     .trajectory;
  return c;
}

TEST(Controller, trajectories_queue_with_switch_times_and_are_joined_exactly_there) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand first = b.command(ControllerBench::arm(1.2, 0.5, -0.5), 1);
  const TrajectoryCommand second =
      planned_for_a_switch(b, first, 1.5, ControllerBench::arm(0.3, -0.4, 0.2), 2);
  TrajectoryCommand third = second;  // from the end of the second
  third.id = 3;
  const KinematicLimits& l = b.robot->comfort_limits();
  third.trajectory = solve(rest_state(ControllerBench::arm(0.3, -0.4, 0.2)),
                           rest_state(ControllerBench::arm(0.8, 0, 0)),
                           {l.velocity.head(3), l.acceleration.head(3), l.jerk.head(3)})
                         .trajectory;
  ASSERT_EQ(b.send(first), "");
  ASSERT_EQ(b.send(second, 0.0, 1.5), "");
  ASSERT_EQ(b.send(third, 0.0, 1e6), "");
  EXPECT_EQ(b.core.status().trajectory, 3u);
  EXPECT_EQ(b.core.status().motion, MotionState::running);
  EXPECT_EQ(b.core.status().progress, 0.0);
  const double duration = second.trajectory.duration();
  double t = 0.0;
  for (int k = 0; k < 20000 && b.core.status().motion == MotionState::running; ++k) {
    b.tick();
    t += b.settings.period;
    const Vector q = b.core.set_point().position.head(3);
    if (t < 1.499) {
      ASSERT_EQ(b.core.active().trajectory, 1u) << t;
      ASSERT_TRUE(q.isApprox(first.trajectory.at(t).position, 1e-9)) << t;
    } else if (t > 1.501 && t < 1.499 + duration) {
      ASSERT_EQ(b.core.active().trajectory, 2u) << t;
      ASSERT_LT((q - second.trajectory.at(t - 1.5).position).cwiseAbs().maxCoeff(), 1e-6) << t;
    }
  }
  EXPECT_NEAR(t, 1.5 + duration + third.trajectory.duration(), 0.003);
  EXPECT_TRUE(b.core.set_point().position.head(3).isApprox(ControllerBench::arm(0.8, 0, 0), 1e-6));
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  expect_smooth(b);
}

TEST(Controller, what_begins_nearly_as_the_arm_moves_is_joined_without_a_detour) {
  for (const double off : {1e-13, 1e-9, 1e-6, 1e-4, 1e-3}) {
    ControllerBench b;
    b.start();
    const TrajectoryCommand first = b.command(ControllerBench::arm(1.2, 0.5, -0.5), 1);
    TrajectoryCommand second =
        planned_for_a_switch(b, first, 1.5, ControllerBench::arm(1.6, -0.4, 0.2), 2);
    for (AxisTrajectory& axis : second.trajectory.axes) axis.start.position -= off;
    ASSERT_EQ(b.send(first), "");
    b.run(0.5);
    ASSERT_EQ(b.send(second, 0.0, 1.5), "");
    const double whole = b.core.active().rest.duration();
    EXPECT_NEAR(whole, 1.5 + second.trajectory.duration(), 0.15) << off;
    for (double t = 1.5; t < whole; t += 0.01)
      ASSERT_LT((b.core.active().rest.at(t).position -
                 second.trajectory.at(t - whole + second.trajectory.duration()).position)
                    .norm(),
                0.02)
          << off << " at " << t;
  }
}

TEST(Controller, a_queued_switch_is_kept_through_slowing_holding_and_running_back) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand first = b.command(ControllerBench::arm(1.2, 0.5, -0.5), 1);
  ASSERT_EQ(b.send(first), "");
  b.run(0.5);
  ASSERT_EQ(b.send(planned_for_a_switch(b, first, 1.5, ControllerBench::arm(0.3, -0.4, 0.2), 2),
                   0.0, 1.5),
            "");
  b.advice.speed_factor = 0.4;
  b.run(2.2);
  b.advice.speed_factor = -1.0;
  b.run(2.0);
  b.advice.speed_factor = 0.7;
  b.run(1.0);
  b.go.allowed = false;
  b.run(1.0);
  b.go.allowed = true;
  ++b.go.epoch;
  b.run(8.0);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(
      b.core.set_point().position.head(3).isApprox(ControllerBench::arm(0.3, -0.4, 0.2), 1e-6));
  expect_smooth(b);
}

TEST(Controller, one_that_leaves_at_once_ends_those_that_wait) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand first = b.command(ControllerBench::arm(1.2, 0.5, -0.5), 1);
  ASSERT_EQ(b.send(first), "");
  ASSERT_EQ(b.send(planned_for_a_switch(b, first, 1.5, ControllerBench::arm(0.3, -0.4, 0.2), 2),
                   0.0, 1.5),
            "");
  b.run(1.0);
  ASSERT_EQ(b.go_to(ControllerBench::arm(0.9, 0.9, 0.0), 3), "");
  b.run(8);
  EXPECT_EQ(b.core.status().trajectory, 3u);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(
      b.core.set_point().position.head(3).isApprox(ControllerBench::arm(0.9, 0.9, 0.0), 1e-6));
}

TEST(Controller, a_stop_command_ends_those_that_wait_too) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand first = b.command(ControllerBench::arm(1.2, 0.5, -0.5), 1);
  ASSERT_EQ(b.send(first), "");
  ASSERT_EQ(b.send(planned_for_a_switch(b, first, 1.5, ControllerBench::arm(0.3, -0.4, 0.2), 2),
                   0.0, 1.5),
            "");
  b.run(1.0);
  TrajectoryCommand stop;
  stop.robot = "small";
  stop.id = 3;
  stop.epoch = 1;
  ASSERT_EQ(b.send(stop), "");
  b.run(3.0);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.active().trajectory, 0u);
  EXPECT_EQ(b.core.status().motion, MotionState::stopped);
}

TEST(Controller, refused_in_motion_with_the_reason_and_the_running_one_goes_on) {
  ControllerBench b;
  b.start();
  const TrajectoryCommand good = b.command(goal(), 1);
  ASSERT_EQ(b.send(good), "");
  std::uint64_t id = 1;
  const auto refused = [&](TrajectoryCommand c, double age, const char* text,
                           double switch_at = 0.0) {
    c.id = ++id;
    EXPECT_THAT(b.send(c, age, switch_at), HasSubstr(text));
    EXPECT_EQ(b.core.status().motion, MotionState::refused);
    EXPECT_EQ(b.core.status().trajectory, id);
    EXPECT_THAT(b.core.status().reason, HasSubstr(text));
    b.run(0.1);
    EXPECT_EQ(b.core.active().trajectory, 1u);
  };
  b.run(0.5);
  TrajectoryCommand c = good;
  for (AxisTrajectory& axis : c.trajectory.axes) axis.start.position -= 1.0;
  refused(c, 0, "no nearer than");
  c = good;
  c.trajectory.axes[1].segments[0].jerk *= 3;
  refused(c, 0, "axis 1");
  refused(good, 2.0, "s old");
  c = good;
  c.robot = "other";
  refused(c, 0, "robot other");
  c = good;
  c.trajectory = cut(good.trajectory, 0.0, 0.5 * good.trajectory.duration());
  refused(c, 0, "end at rest");
  c = good;
  c.axes = {0, 2, 1};
  refused(c, 0, "other axes");
  refused(good, 0, "switch_at", std::numeric_limits<double>::quiet_NaN());
  refused(good, 0, "no nearer than", 100.0);  // in line with the end, but with another start
  b.run(0.2);
  EXPECT_EQ(b.core.status().motion, MotionState::running)
      << "a refusal is told for a moment, then what runs again";
  EXPECT_EQ(b.core.status().trajectory, 1u);
  b.run(5);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_TRUE(b.core.set_point().position.head(3).isApprox(goal(), 1e-9));
}

TEST(Controller, refused_beside_the_path_and_the_path_to_be_rejoined_is_shown_again) {
  int tried = 0;
  for (int cycles = 1; cycles < 800 && tried < 3; ++cycles) {
    ControllerBench b;
    b.start();
    const TrajectoryCommand good = b.command(ControllerBench::arm(1.5, 0.5, -0.5), 1);
    ASSERT_EQ(b.send(good), "");
    b.run(b.settings.period * cycles);
    const TrajectoryCommand in_motion = planned_for_a_switch(b, good, 0.5, goal(), 2);
    b.forecast.trajectory = 1;
    b.forecast.collides = true;
    b.core.on(b.forecast, b.now);
    b.run(1.5);
    ASSERT_TRUE(b.at_rest());
    const bool left = b.core.active().trajectory == 0;  // a stop on the path would take longer
    if (!left) continue;
    ++tried;
    EXPECT_THAT(b.send(in_motion, 0, 0.5), HasSubstr("does not start at rest"));
    EXPECT_EQ(b.core.status().motion, MotionState::refused);
    b.forecast.collides = false;
    ++b.go.epoch;
    b.run(0.5);
    EXPECT_EQ(b.core.active().trajectory, 1u);
    EXPECT_EQ(b.core.status().trajectory, 1u) << "the arm moves, and the refusal is still shown";
    EXPECT_EQ(b.core.status().motion, MotionState::running);
    b.run(6);
    EXPECT_EQ(b.core.status().motion, MotionState::finished);
    expect_smooth(b);
  }
  EXPECT_GT(tried, 0) << "no stop led off the path";
}

TEST(Controller, a_connecting_motion_never_leaves_the_bounds_of_an_axis) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(2.89, 0, 0), 1), "");
  int refused = 0, taken = 0;
  for (int k = 0; k < 70; ++k) {
    b.run(0.1);
    const Vector here = b.core.set_point().position.head(3);
    if (here[0] < 2.3 || b.at_rest()) continue;
    // Continues outward and ends at the bound: the stop of a moving axis would exceed the bound.
    TrajectoryCommand c =
        b.command(ControllerBench::arm(here[0] + 0.02, 0, 0), 100 + static_cast<std::uint64_t>(k));
    const std::string why = b.send(c);
    (why.empty() ? taken : refused) += 1;
    EXPECT_TRUE(why.empty() || why.find("bounds") != std::string::npos) << why;
  }
  EXPECT_GT(taken, 0);
  b.run(3);
  EXPECT_LE(b.core.set_point().position[0], 2.9);
  expect_smooth(b);
}

TEST(Controller, more_than_eight_do_not_wait) {
  ControllerBench b;
  b.start();
  TrajectoryCommand c = b.command(goal(), 1);
  ASSERT_EQ(b.send(c), "");
  Trajectory there = c.trajectory, back = reversed(c.trajectory);
  std::string why;
  for (std::uint64_t id = 2; id < 12 && why.empty(); ++id) {
    c.id = id;
    c.trajectory = id % 2 ? there : back;
    why = b.send(c, 0.0, 1e6);
    EXPECT_TRUE(why.empty() || id == 10u) << id;
  }
  EXPECT_THAT(why, HasSubstr("wait already"));
  for (int k = 0; k < 60000 && b.core.active().trajectory != 0; ++k) b.tick();
  EXPECT_EQ(b.core.status().trajectory, 9u);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_queue_test
