// SPDX-License-Identifier: Apache-2.0
// The head: its gaze target, and its clearance to the arm.
#include "components/trajectory_controller/controller.hpp"

#include <gtest/gtest.h>

#include "components/trajectory_controller/head/gaze.hpp"
#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::gaze_test {
namespace {

using test::ControllerBench;
using test::goal;
using test::has;

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
  const std::vector<double> q =
      aim(*robot, robot->require_group("head"), Vector::Zero(robot->dof()), Vector3(0.2, 0, 5.0));
  EXPECT_LE(q[1], 0.5 + 1e-12);
  EXPECT_GE(q[1], -0.7 - 1e-12);
}

/// The forearm has just passed in front of the camera: a further nod to a seated person would push
/// the camera into the forearm.
TEST(HeadRoom, the_head_does_not_turn_into_the_arm) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  HeadRoom room(robot, HeadSettings{}.clearance);
  Vector q = robot.rest_configuration();
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
  away.head(7) = robot.rest_configuration().head(7);
  EXPECT_TRUE(room.lets_turn(away, {-1.0, -0.7})) << "nothing is there";
}

/// The arm is still beside the head, and its path passes in front of the camera before it ends
/// where it began: the head must not turn into the passage.
TEST(HeadController, the_head_does_not_turn_to_where_the_arm_will_pass) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const std::vector<int>& axes = robot.require_group("head").axes;
  Vector here = robot.rest_configuration();
  here[axes[0]] = 0.001;
  here[axes[1]] = 0.127;
  Vector passing = here;
  passing.head(7) << -0.286, 1.673, -0.285, -1.170, -1.204, 1.639, -1.292;
  std::vector<Pose> T_root_link;
  robot.forward(here, T_root_link);
  AttentionAdvice advice;
  advice.has_gaze_target = true;
  for (const double down : {0.2, 0.4, 0.6, 0.8, 1.0, 1.2}) {
    advice.gaze_target =
        T_root_link[static_cast<std::size_t>(robot.gaze_link())] * Vector3(1.0, 0.1, -down);
    const std::vector<double> target =
        aim(robot, robot.require_group("head"), here, advice.gaze_target);
    HeadRoom room(robot, HeadSettings{}.clearance);
    if (room.lets_turn(passing, target)) continue;
    HeadController head(robot, axes, {});
    head.aim_at(advice, Pose::Identity(), here, {passing, here});
    EXPECT_TRUE(head.has_new_target(advice)) << "refused, to be tried again";
    head.aim_at(advice, Pose::Identity(), here, {here});
    EXPECT_FALSE(head.has_new_target(advice)) << "accepted once the arm has passed";
    return;
  }
  FAIL() << "no gaze of this test collides with the arm";
}

}  // namespace
}  // namespace handsel::trajectory_controller::gaze_test
