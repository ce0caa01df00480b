// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/pose_goals.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handsel::path_planner::pose_goals_test {
namespace {

class PoseGoalsOfJido : public ::testing::Test {
 protected:
  Pose tip(const Vector& group_q) {
    return robot_.link_pose(RobotModel::with(start_, arm_, group_q), arm_.tip);
  }
  Pose somewhere(std::mt19937& random) {
    Vector q(arm_.axes.size());
    for (std::size_t i = 0; i < arm_.axes.size(); ++i)
      q[static_cast<Eigen::Index>(i)] = std::uniform_real_distribution<double>(
          0.9 * robot_.axes()[arm_.axes[i]].lower, 0.9 * robot_.axes()[arm_.axes[i]].upper)(random);
    return tip(q);
  }

  RobotModel robot_{
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb")};
  const Group& arm_{robot_.require_group("arm")};
  Vector start_{robot_.rest_configuration()};
};

TEST_F(PoseGoalsOfJido, postures_reach_their_poses_and_regions) {
  std::mt19937 random(3);
  std::vector<PoseGoal> poses(10);
  for (PoseGoal& pose : poses) pose.T_root_tip = somewhere(random);
  for (std::size_t i = 5; i < 10; ++i) poses[i].slack = Vector3(0.03, 0, 0.01), poses[i].turn = 0.4;
  const PoseGoals found = reach(robot_, arm_, poses, start_, 1, 6);
  ASSERT_EQ(found.goals.size(), found.pose.size());
  std::vector<int> of_pose(poses.size(), 0);
  for (std::size_t k = 0; k < found.goals.size(); ++k) {
    const PoseGoal& pose = poses[found.pose[k]];
    ++of_pose[found.pose[k]];
    const Pose off = pose.T_root_tip.inverse() * tip(found.goals[k]);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LE(std::abs(off.translation()[axis]), pose.slack[axis] + 1e-4);
    EXPECT_LE(Eigen::AngleAxisd(off.linear()).angle(), pose.turn + 1e-3);
    EXPECT_NEAR(off.linear()(2, 2), 1.0, 1e-4) << "turned about another axis";
  }
  EXPECT_GE(std::count_if(of_pose.begin(), of_pose.end(), [](int n) { return n > 1; }), 8);
  EXPECT_TRUE(found.reason.empty());
  EXPECT_EQ(reach(robot_, arm_, poses, start_, 1, 6).goals, found.goals);
}

TEST_F(PoseGoalsOfJido, what_no_posture_reaches_is_said) {
  PoseGoal far;
  far.T_root_tip = make_pose({4, 0, 1});
  EXPECT_THAT(reach(robot_, arm_, {far}, start_, 1, 3).reason,
              testing::HasSubstr("no configuration of the group \"arm\" reaches the goal"));
  EXPECT_THAT(reach(robot_, arm_, {far, far}, start_, 1, 3).reason,
              testing::HasSubstr("of the 2 goals none"));
  EXPECT_THAT(reach(robot_, arm_, {}, start_, 1, 3).reason, testing::HasSubstr("no goal"));
}

}  // namespace
}  // namespace handsel::path_planner::pose_goals_test
