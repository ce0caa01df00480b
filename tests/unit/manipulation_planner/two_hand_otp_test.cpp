// SPDX-License-Identifier: Apache-2.0
// Exchange points of an object that both hands offer.
#include "components/manipulation_planner/handover/two_hand_otp.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::two_hand_otp_test {
namespace {

/// A robot with two arms at the origin and a tray with its long axis across before it.
class TwoHandOtpTest : public testing::Test {
 protected:
  TwoHandOtpTest() {
    scene_.robot_known = true;
    anna_.id = "anna";
    stand_at({1.2, 0, 0});
    T_world_tray_ =
        make_pose({0.45, 0, 0.9},
                  Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitZ())));
  }
  void stand_at(const Vector3& feet) {
    anna_.joints = standing_body(feet, std::atan2(-feet.y(), -feet.x()), 1.75);
  }
  TwoHandOtp find() const {
    const TwoHandOtpQuery query{scene_,   anna_,
                                {},       T_world_tray_,
                                extent_,  {{{0.1, 0.2, 1.3}, reach_}, {{0.1, -0.2, 1.3}, reach_}},
                                {0, 0, 0}};
    return find_two_hand_otp(query, rig::settings());
  }
  Vector3 torso() const {
    return anna_.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  }

  Scene scene_;
  Person anna_;
  Pose T_world_tray_{Pose::Identity()};
  Eigen::AlignedBox3d extent_{Vector3(-0.28, -0.11, -0.07), Vector3(0.28, 0.11, 0.07)};
  double reach_{0.9};
};

TEST_F(TwoHandOtpTest, turns_the_long_axis_across_the_direction_to_the_person) {
  for (const double y : {-0.5, 0.0, 0.5}) {
    stand_at({1.1, y, 0});
    const TwoHandOtp found = find();
    ASSERT_FALSE(found.T_world_object.empty()) << found.reason;
    const Pose& T = found.T_world_object.front();
    const Vector3 direction = torso().cwiseProduct(Vector3(1, 1, 0)).normalized();
    EXPECT_LT(std::abs(T.linear().col(0).dot(direction)), 0.55) << "at y = " << y;
    EXPECT_NEAR(T.linear()(2, 2), 1, 1e-9) << "the tray stays level";
    EXPECT_LT((T.translation() - torso()).head<2>().norm(), 0.9);
    EXPECT_GT((T.translation() - torso()).head<2>().norm(), 0.35);
  }
}

TEST_F(TwoHandOtpTest, both_ends_are_within_reach_of_the_arms) {
  const double max_stretch = rig::settings().two_hand_max_stretch;
  const TwoHandOtp found = find();
  ASSERT_FALSE(found.T_world_object.empty()) << found.reason;
  EXPECT_LE(found.T_world_object.size(), rig::settings().two_hand_exchange_goals);
  for (const Pose& T : found.T_world_object) {
    const Vector3 left = T * Vector3(0.28, 0, 0), right = T * Vector3(-0.28, 0, 0);
    EXPECT_LE((left - Vector3(0.1, 0.2, 1.3)).norm(), max_stretch * reach_ + 1e-9);
    EXPECT_LE((right - Vector3(0.1, -0.2, 1.3)).norm(), max_stretch * reach_ + 1e-9);
  }
}

TEST_F(TwoHandOtpTest, no_part_of_the_object_is_in_furniture) {
  const TwoHandOtp before = find();
  ASSERT_FALSE(before.T_world_object.empty()) << before.reason;
  // A post beside the middle of the best place, where only the end of the tray would be.
  const Pose best = before.T_world_object.front();
  const Vector3 p_post = best * Vector3(0.25, 0, 0);
  scene_.boxes.push_back({"post", make_pose(p_post), {0.05, 0.05, 0.6}, false});
  for (const Pose& T : find().T_world_object) {
    const Vector3 in_tray = T.inverse() * p_post;
    EXPECT_FALSE(std::abs(in_tray.x()) < 0.28 && std::abs(in_tray.y()) < 0.11);
  }
}

TEST_F(TwoHandOtpTest, says_why_there_is_none) {
  stand_at({3, 0, 0});
  TwoHandOtp found = find();
  EXPECT_TRUE(found.T_world_object.empty());
  EXPECT_THAT(found.reason, testing::HasSubstr("beyond the reach of both arms"));
  extent_.setEmpty();
  EXPECT_THAT(find().reason, testing::HasSubstr("an object of known size"));
}

/// Gives the mug with both hands; `robot`: description.
ActionStatus give_with_both(const std::string& robot) {
  rig::Rig rig(robot);
  ActionGoal goal;
  goal.kind = ActionKind::give;
  goal.object = "mug";
  goal.human = "anna";
  goal.both_hands = true;
  rig.start(goal);
  rig.run(30);
  return rig.planner.status();
}

TEST(GiveTogether, is_refused_by_a_robot_with_one_arm) {
  const ActionStatus status = give_with_both("jido");
  EXPECT_EQ(status.state, ActionState::failed);
  EXPECT_THAT(status.reason, testing::HasSubstr("needs two hands, robot jido has one"));
}

TEST(GiveTogether, is_refused_while_a_hand_holds_something) {
  rig::Rig rig("duo");
  rig.scene.objects.push_back({"cup", "mug", rig.tool(), Holder::robot, "hand", 0});
  rig.cycle();
  ActionGoal hold;
  hold.kind = ActionKind::give;
  hold.object = "cup";
  hold.human = "nobody";
  rig.start(hold);
  rig.run(0.2);
  ActionGoal goal;
  goal.kind = ActionKind::give;
  goal.object = "mug";
  goal.human = "anna";
  goal.both_hands = true;
  rig.start(goal);
  rig.run(5);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_THAT(rig.planner.status().reason, testing::HasSubstr("cup is in the hand"));
}

}  // namespace
}  // namespace handsel::manipulation_planner::two_hand_otp_test
