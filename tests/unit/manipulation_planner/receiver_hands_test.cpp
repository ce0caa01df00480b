// SPDX-License-Identifier: Apache-2.0
// The planner's choice of the receiver's hand, from the choice of the grasp to the offer.
#include <numbers>

#include "tests/unit/manipulation_planner/manipulation_rig.hpp"
#include "tests/unit/manipulation_planner/partner_grasps.hpp"

namespace handsel::manipulation_planner::receiver_hands_test {
namespace {

using rig::Rig;

/// Raises one hand of the receiver before the body; the other hangs. `turn`: of the body, from the
/// direction to the robot [rad].
void raise_hand(Rig& rig, Side side, double turn = 0) {
  Person& anna = rig.people.people[0];
  anna.joints = standing_body({1.45, 0, 0}, std::numbers::pi + turn, 1.75);
  anna.joints[static_cast<std::size_t>(body_joint_index(side == Side::left ? "l_hand" : "r_hand"))]
      .position += Eigen::AngleAxisd(turn, Vector3::UnitZ()) * Vector3(-0.3, 0, 0.35);
}

/// Returns a grasp of the mug near where the arm is.
Grasp grasp_near_arm(const Rig& rig, std::uint64_t id, double first_axis) {
  const Group &arm = rig.robot->require_group("arm"), &hand = rig.robot->require_group("hand");
  Grasp grasp;
  grasp.id = id;
  grasp.arm_joints = RobotModel::part(rig.q, arm);
  grasp.arm_joints[0] += first_axis;
  grasp.approach_joints = grasp.arm_joints;
  grasp.approach_joints[1] += 0.1;
  grasp.hand_joints = grasp.pregrasp_joints = RobotModel::part(rig.q, hand);
  grasp.T_object_hand =
      rig.scene.objects[0].T_world_object.inverse() * rig.scene.T_world_base *
      rig.robot->link_pose(RobotModel::with(rig.q, arm, grasp.arm_joints), rig.robot->tool_link());
  return grasp;
}

/// Picks the mug up and carries it to the receiver, whose right hand is raised.
void carry_to_receiver(Rig& rig) {
  rig.grasps = {grasp_near_arm(rig, 1, 0.2)};
  // The object keeps its pose in the hand: horizontal grasps of the person are rotated accordingly.
  const Vector q =
      RobotModel::with(rig.q, rig.robot->require_group("arm"), rig.grasps[0].arm_joints);
  const Eigen::Matrix3d R_tool_world =
      rig.robot->link_pose(q, rig.robot->tool_link()).linear().transpose();
  for (PartnerGrasp partner : rig::from_all_sides()) {
    partner.T_object_wrist = Pose(R_tool_world) * partner.T_object_wrist;
    rig.grasps[0].partners.push_back(partner);
  }
  raise_hand(rig, Side::right);
  rig.start(ActionKind::pick);
  rig.run(30);
  ASSERT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  rig.moves = true;
  rig.start(ActionKind::give);
  rig.run_until("carry");
  ASSERT_TRUE(rig.planner.status().has_partner);
  EXPECT_EQ(rig.planner.status().partner_side, Side::right);
}

/// Returns the motion of the receiver's planned wrist while the object is carried [m].
double wrist_shift(Rig& rig) {
  const Vector3 before = rig.planner.status().T_world_partner_wrist.translation();
  for (int i = 0; i < 30 && phase_text(rig.planner.status()) == "carry"; ++i) rig.cycle();
  EXPECT_TRUE(rig.planner.status().has_partner);
  return (rig.planner.status().T_world_partner_wrist.translation() - before).norm();
}

TEST(ReceiverHands, a_change_of_hand_while_the_object_is_carried_changes_the_plan) {
  Rig rig;
  carry_to_receiver(rig);
  raise_hand(rig, Side::left);
  EXPECT_GT(wrist_shift(rig), 0.05);
  EXPECT_EQ(rig.planner.status().partner_side, Side::left);
}

TEST(ReceiverHands, a_turn_in_place_while_the_object_is_carried_changes_the_plan) {
  for (const double turn : {0.1, 0.8}) {
    Rig rig;
    carry_to_receiver(rig);
    raise_hand(rig, Side::right, turn);
    const double shift = wrist_shift(rig);
    EXPECT_EQ(shift > 0.05, turn > 0.5) << "turned by " << turn << ": " << shift;
  }
}

TEST(ReceiverHands, of_two_grasps_the_one_that_leaves_the_person_a_grasp_is_taken) {
  for (const std::size_t with : {std::size_t{0}, std::size_t{1}}) {
    Rig rig;
    rig.grasps = {grasp_near_arm(rig, 1, 0.2), grasp_near_arm(rig, 2, 0.25)};
    rig.grasps[with].partners = rig::from_all_sides();
    rig.start(ActionKind::pick);
    rig.run_until("approach");
    ASSERT_EQ(rig.last_path.goals.size(), 1U);
    EXPECT_LT((rig.last_path.goals[0] - rig.grasps[with].approach_joints).norm(), 1e-6)
        << "grasp " << with + 1;
  }
}

}  // namespace
}  // namespace handsel::manipulation_planner::receiver_hands_test
