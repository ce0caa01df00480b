// SPDX-License-Identifier: Apache-2.0
// Trajectories that move arm, hand and head together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/trajectory_controller/controller.hpp"
#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_whole_robot_test {
namespace {

using test::ControllerBench;
using test::expect_smooth;
using testing::HasSubstr;

class WholeRobotTest : public testing::Test {
 protected:
  void SetUp() override { bench_.start(); }

  std::string close_hand(std::uint64_t id, HandAction action = HandAction::move) {
    HandCommand c;
    c.robot = "small";
    c.id = id;
    c.epoch = bench_.go.epoch;
    c.action = action;
    c.position = Vector::Constant(2, 1.2);
    return bench_.core.accept(c, Duration(0), bench_.now);
  }
  void look_aside() {
    bench_.advice.has_gaze_target = true;
    bench_.advice.gaze_target = Vector3(0.5, 3.0, 1.5);
  }
  void expect_at(const Vector& goal) {
    EXPECT_TRUE(bench_.core.set_point().position.isApprox(goal, 1e-9))
        << bench_.core.set_point().position.transpose();
    EXPECT_TRUE(bench_.at_rest());
  }

  ControllerBench bench_;
  const Vector goal_ = (Vector(7) << 0.6, 0.4, -0.5, 0.7, 0.9, -0.4, 0.2).finished();
};

TEST_F(WholeRobotTest, arm_hand_and_head_arrive_together) {
  const TrajectoryCommand c = bench_.command_all(goal_, 1);
  ASSERT_EQ(bench_.send(c), "");
  double off = 0.0;
  while (bench_.core.status().motion == MotionState::running && bench_.ticks < 20000) {
    bench_.tick();
    const ActiveTrajectory active = bench_.core.active();
    if (active.trajectory == 0) continue;
    const Vector on_path = c.trajectory.at(active.time).position;
    off = std::max(off, (bench_.core.set_point().position - on_path).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(off, 1e-9) << "every axis is where the trajectory has it";
  expect_at(goal_);
  bench_.run(1.0);
  expect_at(goal_);
  expect_smooth(bench_);
}

TEST_F(WholeRobotTest, the_hand_takes_no_command_until_the_trajectory_is_over) {
  ASSERT_EQ(bench_.send(bench_.command_all(goal_, 1)), "");
  bench_.run(0.3);
  EXPECT_THAT(close_hand(2), HasSubstr("a trajectory moves the fingers"));
  bench_.run(5.0);
  expect_at(goal_);
  EXPECT_EQ(close_hand(3), "");
  bench_.run(2.0);
  EXPECT_NEAR(bench_.core.set_point().position[3], 1.2, 1e-9);
  EXPECT_NEAR(bench_.core.set_point().position[5], goal_[5], 1e-9);
  expect_smooth(bench_);
}

TEST_F(WholeRobotTest, a_hand_that_moves_or_holds_is_not_part_of_a_trajectory) {
  ASSERT_EQ(close_hand(2), "");
  bench_.run(0.1);
  EXPECT_THAT(bench_.send(bench_.command_all(goal_, 1)),
              HasSubstr("executes a command or holds something"));
  bench_.run(2.0);
  EXPECT_EQ(bench_.send(bench_.command_all(goal_, 3)), "")
      << "the hand has finished and holds nothing";
  bench_.run(5.0);
  ASSERT_EQ(close_hand(4, HandAction::grasp), "");
  bench_.run(0.5);
  EXPECT_THAT(bench_.send(bench_.command_all(Vector::Zero(7), 5)), HasSubstr("holds something"));
  EXPECT_EQ(bench_.go_to(Vector::Zero(3), 6), "") << "the arm alone";
}

TEST_F(WholeRobotTest, a_head_that_turns_is_led_over_to_the_trajectory) {
  look_aside();
  bench_.run(0.35);
  const double pan = bench_.core.set_point().velocity[5];
  ASSERT_GT(std::abs(pan), 0.1);
  ASSERT_EQ(bench_.send(bench_.command_all(goal_, 1)), "");
  bench_.tick();
  EXPECT_GT(bench_.core.set_point().velocity[5] / pan, 0.5) << "without a stop";
  while (bench_.core.status().motion == MotionState::running && bench_.ticks < 20000) bench_.tick();
  EXPECT_EQ(bench_.core.status().motion, MotionState::finished);
  EXPECT_NEAR(bench_.core.set_point().position[5], goal_[5], 1e-6);
  bench_.run(3.0);
  EXPECT_GT(bench_.core.set_point().position[5], 0.5) << "the head turns to its target again";
  expect_smooth(bench_);
}

TEST_F(WholeRobotTest, all_axes_stop_together_and_are_free_again) {
  ASSERT_EQ(bench_.send(bench_.command_all(goal_, 1)), "");
  bench_.run(0.4);
  ASSERT_GT(std::abs(bench_.core.set_point().velocity[3]), 0.1);
  bench_.drive = DriveMode::protective_stop;
  bench_.run(3.5);
  EXPECT_TRUE(bench_.at_rest());
  const Vector stopped = bench_.core.set_point().position;
  EXPECT_GT((stopped - goal_).cwiseAbs().maxCoeff(), 0.1);
  bench_.drive = DriveMode::enabled;
  bench_.run(0.1);
  ++bench_.go.epoch;
  bench_.go.acknowledge = true;
  bench_.run(0.5);
  ASSERT_EQ(bench_.core.mode(), Mode::normal) << bench_.core.status().reason;
  EXPECT_EQ(close_hand(2), "");
  bench_.run(2.0);
  EXPECT_NEAR(bench_.core.set_point().position[3], 1.2, 1e-9);
  expect_smooth(bench_);
}

TEST_F(WholeRobotTest, a_hold_interrupts_all_axes_and_the_trajectory_is_rejoined) {
  ASSERT_EQ(bench_.send(bench_.command_all(goal_, 1)), "");
  bench_.run(0.4);
  bench_.go.allowed = false;
  bench_.run(1.5);
  ASSERT_TRUE(bench_.at_rest());
  EXPECT_NE(close_hand(2), "") << "the trajectory still has the fingers";
  bench_.go.allowed = true;
  ++bench_.go.epoch;
  bench_.run(6.0);
  EXPECT_EQ(bench_.core.status().motion, MotionState::finished);
  EXPECT_TRUE(bench_.core.set_point().position.isApprox(goal_, 1e-6));
  expect_smooth(bench_);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_whole_robot_test
