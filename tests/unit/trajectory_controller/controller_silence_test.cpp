// SPDX-License-Identifier: Apache-2.0
// Silent senders: the resulting mode, and how motion continues.
#include "components/trajectory_controller/controller.hpp"

#include <gtest/gtest.h>

#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_silence_test {
namespace {

using test::ControllerBench;
using test::expect_smooth;
using test::goal;
using test::has;

struct Silence {
  const char* what;
  bool ControllerBench::*source;
  double within;  // max time of detection [s]
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
  EXPECT_EQ(b.core.status().motion,
            s.mode == Mode::hold ? MotionState::finished : MotionState::stopped);
  EXPECT_LE(b.worst_velocity, 1 + 1e-6);
  EXPECT_LE(b.worst_acceleration, 1 + 1e-6);
  EXPECT_LE(b.worst_jerk, 1 + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(table, SilentSource,
                         testing::Values(Silence{"robot", &ControllerBench::robot_speaks, 0.02,
                                                 Mode::stop, Cause::robot_state_silent},
                                         Silence{"human", &ControllerBench::human_speaks, 0.2,
                                                 Mode::stop, Cause::human_state_silent},
                                         Silence{"forecast", &ControllerBench::forecast_speaks, 0.1,
                                                 Mode::hold, Cause::forecast_silent},
                                         Silence{"attention", &ControllerBench::attention_speaks,
                                                 0.3, Mode::slow, Cause::attention_silent}),
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

TEST(Controller, a_robot_side_that_is_started_anew_is_followed_from_where_it_stands) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.0, 0.3, -0.4), 1), "");
  b.run(1.0);
  ASSERT_FALSE(b.at_rest());
  b.robot_speaks = false;
  b.run(0.012);  // simulated time may have paused: no timeout occurs
  RobotState anew;
  anew.robot = "small";
  anew.sequence = 1;
  anew.position = anew.velocity = anew.effort = Vector::Zero(b.robot->dof());
  anew.position[0] = -0.5;
  anew.mode = DriveMode::enabled;
  b.core.on(anew, b.now);
  EXPECT_NE(b.core.set_point().position, anew.position)
      << "a strange sample of the same writer moves nothing";
  b.core.on(anew, b.now, {}, true);
  EXPECT_EQ(b.core.set_point().position, anew.position);
  EXPECT_TRUE(b.at_rest());
  EXPECT_NE(b.core.status().motion, MotionState::running);
}

TEST(Controller, sends_nothing_at_rest_while_no_robot_side_has_been_heard_for_long) {
  ControllerBench b;
  b.start();
  b.run(0.5);
  EXPECT_TRUE(b.ready);
  b.robot_speaks = false;
  b.run(0.4);
  EXPECT_TRUE(b.ready);
  b.run(0.2);
  EXPECT_FALSE(b.ready)
      << "a robot side that comes up elsewhere would take it for its first set-point";
  b.robot_speaks = true;
  b.run(0.1);
  EXPECT_TRUE(b.ready);
  expect_smooth(b);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_silence_test
