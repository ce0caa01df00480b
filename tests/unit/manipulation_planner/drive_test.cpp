// SPDX-License-Identifier: Apache-2.0
// The action that drives the platform, with emulated planners and an emulated controller.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::drive_test {
namespace {

using ::testing::HasSubstr;

class Drive : public ::testing::Test {
 protected:
  Vector3 place() const { return platform_place(*rig_.robot, rig_.q); }
  void drive(const ActionGoal& goal) {
    rig_.start(goal);
    rig_.run(30);
  }
  const ActionStatus& status() const { return rig_.planner.status(); }

  rig::Rig rig_{"jido_mobile"};
};

TEST_F(Drive, goes_to_the_place_of_the_goal_with_the_axes_of_the_platform) {
  rig_.people.people.clear();
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.has_goal = true;
  goal.T_world_goal =
      make_pose({1, -2, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3::UnitZ())));
  const Vector before = rig_.q;
  drive(goal);
  EXPECT_EQ(status().state, ActionState::succeeded) << status().reason;
  EXPECT_LT((place() - Vector3(1, -2, 0.5)).norm(), 1e-9);
  EXPECT_EQ(RobotModel::part(rig_.q, rig_.robot->require_group("arm")),
            RobotModel::part(before, rig_.robot->require_group("arm")));
  EXPECT_EQ(rig_.path_groups.back(), kPlatformGroup);
}

TEST_F(Drive, a_goal_is_meant_in_the_world_wherever_the_odometry_frame_is) {
  rig_.scene.T_world_base =
      make_pose({0.3, 0.2, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3::UnitZ())));
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.has_goal = true;
  goal.T_world_goal = make_pose({1, -2, 0});
  drive(goal);
  EXPECT_EQ(status().state, ActionState::succeeded) << status().reason;
  const Pose T = T_world_platform(*rig_.robot, rig_.q, rig_.scene.T_world_base);
  EXPECT_LT((T.matrix() - goal.T_world_goal.matrix()).norm(), 1e-9);
}

TEST_F(Drive, stops_before_a_person_where_the_arm_reaches_them) {
  rig_.people.people[0].joints = standing_body({3, 1, 0}, -M_PI_2, 1.75);
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.human = "anna";
  drive(goal);
  EXPECT_EQ(status().state, ActionState::succeeded) << status().reason;
  const double away = (place().head<2>() - Eigen::Vector2d(3, 1)).norm();
  EXPECT_LT(place().y(), 0.5) << "she faces toward -y";
  EXPECT_GT(away, 0.7);
  EXPECT_LT(away, 1.9);
}

TEST_F(Drive, goes_where_the_grasp_planner_finds_a_grasp) {
  Grasp grasp;
  grasp.has_platform = true;
  grasp.platform = {0.4, -1.5, 1.2};
  rig_.grasps = {grasp};
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.object = "mug";
  drive(goal);
  EXPECT_EQ(status().state, ActionState::succeeded) << status().reason;
  EXPECT_LT((place() - grasp.platform).norm(), 1e-9);
}

TEST_F(Drive, goes_nearer_when_no_grasp_serves_from_where_the_platform_stopped) {
  Grasp grasp;
  grasp.has_platform = true;
  grasp.platform = {0.4, -1.5, 1.2};
  rig_.grasps = {grasp};
  rig_.after_grasp_reply = [&] {  // only the next grasp is feasible from the place of the stop
    rig_.grasps[0].has_platform = rig_.grasps[0].platform.x() < 0.45;
    rig_.grasps[0].platform.x() += 0.05;
  };
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.object = "mug";
  drive(goal);
  EXPECT_EQ(status().state, ActionState::succeeded) << status().reason;
  EXPECT_NEAR(place().x(), 0.45, 1e-9);
}

TEST_F(Drive, waits_while_others_may_stand_in_the_way_and_not_when_nobody_does) {
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.has_goal = true;
  goal.T_world_goal = make_pose({1, -2, 0});
  rig_.failing_drives = 12;
  drive(goal);
  EXPECT_EQ(status().state, ActionState::succeeded) << status().reason;
  EXPECT_EQ(rig_.failing_drives, 0);
  rig_.people.people.clear();
  rig_.failing_drives = 12;
  goal.T_world_goal = make_pose({2, -2, 0});
  drive(goal);
  EXPECT_EQ(status().state, ActionState::failed);
  EXPECT_GT(rig_.failing_drives, 0);
}

TEST_F(Drive, says_what_is_not_there) {
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.surface = "shelf";
  drive(goal);
  EXPECT_EQ(status().state, ActionState::failed);
  EXPECT_THAT(status().reason, HasSubstr("there is no surface shelf"));
  goal.surface.clear();
  goal.human = "bert";
  drive(goal);
  EXPECT_EQ(status().failure, ActionFailure::not_visible);
}

TEST(DriveWithoutPlatform, is_refused) {
  rig::Rig rig;
  ActionGoal goal;
  goal.kind = ActionKind::drive;
  goal.human = "anna";
  rig.start(goal);
  rig.run(5);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_THAT(rig.planner.status().reason, HasSubstr("has no platform that drives"));
}

}  // namespace
}  // namespace handsel::manipulation_planner::drive_test
