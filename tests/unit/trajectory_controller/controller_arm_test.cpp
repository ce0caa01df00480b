// SPDX-License-Identifier: Apache-2.0
// Arm, hands, head and set-points of the controller: each part alone.
#include <gtest/gtest.h>

#include "common/trajectory/solve.hpp"
#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/arm/command_check.hpp"
#include "components/trajectory_controller/axis_groups.hpp"
#include "components/trajectory_controller/hand/hands.hpp"
#include "components/trajectory_controller/head/head_controller.hpp"
#include "components/trajectory_controller/supervise/stop/stop_samples.hpp"
#include "components/trajectory_controller/supervise/stop_deadline.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::trajectory_controller::controller_arm_test {
namespace {

constexpr double kPeriod = 0.001;

class PartsTest : public testing::Test {
 protected:
  TrajectoryCommand command(const Vector& from, const Vector& to) {
    TrajectoryCommand c;
    c.robot = "small";
    c.id = ++id_;
    c.axes = {0, 1, 2};
    const KinematicLimits limits = limits_of_axes(robot_->comfort_limits(), c.axes);
    c.trajectory = solve(rest_state(from), rest_state(to), limits).trajectory;
    return c;
  }
  void step(ArmOrder order = ArmOrder::run, double wanted = 1.0) {
    set_points_.begin_cycle();
    arm_.step(order, wanted, set_points_);
    set_points_.end_cycle(robot_->guard_limits(), kPeriod);
  }
  void run(double seconds, ArmOrder order = ArmOrder::run, double wanted = 1.0) {
    for (int k = 0; k < static_cast<int>(seconds / kPeriod); ++k) step(order, wanted);
  }
  std::string start(const Vector& to) {
    const MotionState3& sent = set_points_.sent();
    return arm_.accept(command(sent.position.head(3), to), sent);
  }

  std::shared_ptr<const RobotModel> robot_{test::small_robot()};
  AxisGroups groups_{*robot_};
  SetPoints set_points_{robot_->dof()};
  ArmMotion arm_{{kPeriod, 0.05, 0.3}, *robot_, groups_.arm()};
  std::vector<char> none_on_path_ = std::vector<char>(static_cast<std::size_t>(robot_->dof()), 0);
  std::uint64_t id_{};
};

TEST_F(PartsTest, each_axis_belongs_to_one_part) {
  EXPECT_EQ(groups_.arm(), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(groups_.head(), (std::vector<int>{5, 6}));
  EXPECT_EQ(groups_.part(3), Part::hand);
  EXPECT_EQ(groups_.inside(0, 2.91), 2.9) << "noise";
  EXPECT_EQ(groups_.inside(0, 3.5), 3.5) << "no noise";
}

TEST_F(PartsTest, set_points_are_at_rest_until_one_that_moves_is_sent) {
  set_points_.begin_cycle();
  set_points_.next().velocity[1] = 0.1;
  EXPECT_TRUE(set_points_.at_rest());
  EXPECT_TRUE(set_points_.any_moves({0, 1}));
  EXPECT_FALSE(set_points_.any_moves({0, 2}));
  set_points_.end_cycle(robot_->guard_limits(), kPeriod);
  EXPECT_FALSE(set_points_.at_rest());
  EXPECT_GT(set_points_.ratios().velocity, 0.0);
}

TEST_F(PartsTest, a_trajectory_runs_to_its_end) {
  const Vector goal = Vector::Constant(3, 0.2);
  ASSERT_EQ(start(goal), "");
  EXPECT_EQ(arm_.motion(), MotionState::running);
  run(3.0);
  EXPECT_EQ(arm_.motion(), MotionState::finished);
  EXPECT_EQ(arm_.state(), ArmState::at_rest);
  EXPECT_LT((set_points_.sent().position.head(3) - goal).norm(), 1e-9);
}

TEST_F(PartsTest, an_arm_that_left_its_path_rejoins_it) {
  ASSERT_EQ(start(Vector::Constant(3, 0.5)), "");
  run(0.5);
  step(ArmOrder::leave);
  EXPECT_EQ(arm_.state(), ArmState::stopping);
  EXPECT_EQ(arm_.goal(), PathGoal::rejoin);
  EXPECT_TRUE(arm_.active());
  run(2.0);
  ASSERT_EQ(arm_.state(), ArmState::at_rest);
  ASSERT_TRUE(arm_.rejoin(set_points_.sent()));
  run(4.0);
  EXPECT_EQ(arm_.motion(), MotionState::finished);
}

TEST_F(PartsTest, a_stop_gives_the_path_up) {
  ASSERT_EQ(start(Vector::Constant(3, 0.5)), "");
  run(0.5);
  run(2.0, ArmOrder::stop);
  EXPECT_EQ(arm_.motion(), MotionState::stopped);
  EXPECT_EQ(arm_.goal(), PathGoal::end);
  EXPECT_TRUE(set_points_.at_rest());
}

TEST_F(PartsTest, a_cancelled_path_ends_on_the_path_and_is_not_rejoined) {
  ASSERT_EQ(start(Vector::Constant(3, 0.5)), "");
  run(0.5);
  arm_.cancel();
  EXPECT_EQ(arm_.goal(), PathGoal::stop);
  run(2.0, ArmOrder::run, 0.0);
  EXPECT_EQ(arm_.state(), ArmState::at_rest);
  arm_.interrupt_path(true);
  EXPECT_FALSE(arm_.active());
}

TEST_F(PartsTest, a_command_in_motion_is_joined_and_other_axes_are_refused) {
  ASSERT_EQ(start(Vector::Constant(3, 0.5)), "");
  run(0.5);
  TrajectoryCommand next = command(Vector::Constant(3, 0.5), Vector::Zero(3));
  next.switch_at = 100.0;
  EXPECT_TRUE(arm_.joins(next));
  EXPECT_EQ(arm_.accept(next, set_points_.sent()), "");
  EXPECT_EQ(arm_.queue().last().id, next.id);
  next.axes = {0, 1};
  EXPECT_EQ(arm_.accept(next, set_points_.sent()),
            "it moves other axes than trajectory 1, which runs");
}

TEST_F(PartsTest, a_command_names_each_axis_once) {
  TrajectoryCommand c = command(Vector::Zero(3), Vector::Constant(3, 0.2));
  EXPECT_EQ(why_not_executable(c, *robot_), "");
  c.axes = {0, 1, 1};
  EXPECT_EQ(why_not_executable(c, *robot_), "axis shoulder comes twice");
  c.axes = {0, 1, 99};
  EXPECT_EQ(why_not_executable(c, *robot_), "axis 99 does not exist");
  c.axes = {0, 1, 3};
  EXPECT_EQ(why_not_executable(c, *robot_), "") << "a finger may be part of a trajectory";
  const Vector far = Vector::Constant(robot_->dof(), 0.1);
  c.axes = {0, 1, 2};
  EXPECT_NE(why_not_from(rest_state(far), c, *robot_, {0.05, 0.3}), "");
}

TEST_F(PartsTest, commands_of_another_epoch_do_not_count) {
  MotionPermission permission;
  const std::string robot = "small";
  const CommandConditions now{*robot_, permission, true, 0.5, Mode::normal, Cause::none};
  EXPECT_NE(why_not_now({robot, 0, 0.0}, now), "") << "no Go was received";
  Go go;
  go.state_revision = 1;
  go.epoch = 4;
  permission.set(go, {});
  EXPECT_EQ(why_not_now({robot, 4, 0.0}, now), "");
  EXPECT_NE(why_not_now({robot, 4, 0.6}, now), "") << "too old";
}

TEST(CommandQueue, a_switch_drops_what_was_to_come_beyond) {
  CommandQueue queue;
  queue.restart({1, 0.0, 0.0, {}, {}});
  queue.switch_to({2, 1.0, 0.9, {}, {}}, 1.0, 0.0);
  queue.switch_to({3, 2.0, 1.9, {}, {}}, 2.0, 0.0);
  queue.find(1.5);
  EXPECT_EQ(queue.current().id, 2u);
  queue.find(0.5);
  EXPECT_EQ(queue.current().id, 1u);
  queue.switch_to({4, 0.7, 0.6, {}, {}}, 0.8, -0.1);
  queue.find(3.0);
  EXPECT_EQ(queue.current().id, 4u);
  EXPECT_FALSE(queue.full());
}

TEST_F(PartsTest, a_stop_is_due_when_the_fastest_one_would_end_too_late) {
  StopDeadline deadline(*robot_, groups_.arm(), kPeriod);
  MotionState3 moving = rest_state(Vector::Zero(robot_->dof()));
  moving.velocity[0] = 0.4;
  const TimePoint now{from_seconds(10.0)};
  deadline.set_free(moving, now);
  EXPECT_FALSE(deadline.is_due(moving, 0.05, now));
  EXPECT_TRUE(deadline.is_due(moving, 0.05, now + from_seconds(0.05)));
  EXPECT_EQ(deadline.ease(moving), 0.0);
  moving.acceleration[0] = 0.5;
  EXPECT_GT(deadline.ease(moving), 0.0);
}

TEST_F(PartsTest, a_hand_command_of_an_unknown_group_is_refused) {
  Hands hands({}, *robot_, kPeriod);
  HandCommand c;
  c.id = 3;
  c.group = "third";
  EXPECT_EQ(hands.accept(c, "", none_on_path_), "there is no hand \"third\"");
  EXPECT_EQ(hands.last_command(), 3u);
  c.group = "";
  c.position = Vector::Constant(2, 0.5);
  EXPECT_EQ(hands.accept(c, "too old", none_on_path_), "too old");
  EXPECT_FALSE(hands.accepted(3));
  EXPECT_EQ(hands.accept(c, "", none_on_path_), "");
  EXPECT_TRUE(hands.accepted(3));
  EXPECT_TRUE(hands.any_moving());
}

TEST_F(PartsTest, hands_begin_with_what_the_robot_side_holds) {
  Hands hands({}, *robot_, kPeriod);
  ServoReference reference;
  reference.effort = Vector::Zero(robot_->dof());
  reference.payload = 0.4;
  hands.reset(Vector::Zero(robot_->dof()), &reference);
  EXPECT_EQ(hands.payload(), 0.4);
  EXPECT_EQ(hands.held_payload(), 0.4);
  hands.reset(Vector::Zero(robot_->dof()), nullptr);
  EXPECT_EQ(hands.payload(), 0.0);
}

TEST_F(PartsTest, the_head_turns_to_its_target_and_stops_in_hold) {
  HeadController head(*robot_, groups_.head(), {.period = kPeriod});
  AttentionAdvice advice;
  advice.has_gaze_target = true;
  advice.gaze_target = Vector3(1.0, 1.0, 1.3);
  const Vector here = Vector::Zero(robot_->dof());
  ASSERT_TRUE(head.has_new_target(advice));
  head.aim_at(advice, Pose::Identity(), here, {});
  EXPECT_FALSE(head.has_new_target(advice));
  MotionState3 next = rest_state(here);
  for (int k = 0; k < 100; ++k) head.step(true, none_on_path_, next);
  EXPECT_GT(next.velocity[5], 0.0);
  for (int k = 0; k < 1000; ++k) head.step(false, none_on_path_, next);
  EXPECT_EQ(next.velocity[5], 0.0);
}

TEST_F(PartsTest, a_planned_stop_ends_at_rest_and_moves_no_farther_than_its_travel) {
  const std::vector<char> sliding(static_cast<std::size_t>(robot_->dof()), 0);
  StopPlan plan(*robot_, sliding);
  MotionState3 state = rest_state(Vector::Zero(robot_->dof()));
  state.velocity[1] = 0.4;
  state.acceleration[1] = 0.3;
  plan.plan(state, 0.02);
  ASSERT_EQ(plan.count(), 1);
  const AxisStop& axis = plan[0];
  EXPECT_EQ(axis.at(axis.duration + 1.0).velocity, 0.0);
  EXPECT_LE(std::abs(axis.at(axis.duration).position), axis.travel + 1e-12);
  EXPECT_LE(axis.max_speed_between(0.0, axis.duration), axis.max_speed + 1e-12);
  EXPECT_TRUE(plan.inside());
  state.position[1] = 1.999;
  plan.plan(state, 0.0);
  EXPECT_FALSE(plan.inside()) << "beyond the bound of 2 rad";
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_arm_test
