// SPDX-License-Identifier: Apache-2.0
// Receiving: an offered object is taken, a withdrawn object is not pursued.
#include <algorithm>
#include <memory>
#include <numbers>

#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::receive_test {
namespace {

using rig::Rig;

TEST(ManipulationPlanner, takes_what_a_person_holds_out_and_engages_them_only_while_they_offer) {
  Rig rig;
  rig.start(ActionKind::receive);
  rig.run(1);
  EXPECT_EQ(phase_text(rig.planner.status()), "watching for an offer");
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  rig.hold_out();
  bool engaged = false;
  for (int i = 0; i < 1000 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    if (phase_text(rig.planner.status()) == "reaching the object")
      engaged = rig.planner.status().exchange_engaged;
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(engaged);
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"approach", "reaching the object", "retreat"}));
}

/// Offers the mug and has it received, until the action is in this phase. Returns whether it is.
bool receive_until(Rig& rig, const std::string& phase) {
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until(phase);
  return phase_text(rig.planner.status()) == phase;
}

/// With the palm straight below the mug, or straight above it.
Grasp upright_grasp(const Rig& rig, std::uint64_t id, bool from_below) {
  const Group &arm = rig.robot->require_group("arm"), &hand = rig.robot->require_group("hand");
  Grasp grasp;
  grasp.id = id;
  grasp.epsilon = 0.1;
  const Eigen::AngleAxisd tilt(from_below ? 0.0 : std::numbers::pi, Vector3::UnitY());
  grasp.T_object_hand = make_pose(-0.28 * (tilt * Vector3::UnitZ()), Eigen::Quaterniond(tilt));
  const auto joints =
      rig.robot->inverse(arm, rig.scene.objects[0].T_world_object * grasp.T_object_hand,
                         rig.robot->rest_configuration(), {});
  EXPECT_TRUE(joints) << "the arm does not reach it from " << (from_below ? "below" : "above");
  grasp.arm_joints = joints.value_or(RobotModel::part(rig.q, arm));
  grasp.approach_joints = grasp.arm_joints;
  grasp.approach_joints[6] += 0.05;
  grasp.hand_joints = grasp.pregrasp_joints = RobotModel::part(rig.q, hand);
  return grasp;
}

/// An offer of two grasps: from below, which is nearer and by which nothing can be put on a table,
/// and from above.
struct TwoGrasps {
  double margin_below{1.0}, margin_above{1.0};  ///< of the forces of the grip [N]
  bool has_table{false};
  settings::ManipulationPlannerSettings settings{rig::settings()};
};

/// Returns a rig that begins to receive an object offered with these grasps.
std::unique_ptr<Rig> receiving(const TwoGrasps& two) {
  auto made = std::make_unique<Rig>("jido", two.settings);
  Rig& rig = *made;
  rig.hold_out();
  rig.scene.objects[0].T_world_object = make_pose({0.7, -0.2, 1.0});
  rig.grasped_as_it_stands = true;
  rig.grasps = {upright_grasp(rig, 1, true), upright_grasp(rig, 2, false)};
  rig.grasps[0].margin = two.margin_below;
  rig.grasps[1].margin = two.margin_above;
  const Vector &below = rig.grasps[0].approach_joints, &above = rig.grasps[1].approach_joints;
  rig.q = RobotModel::with(rig.q, rig.robot->require_group("arm"), below + 0.35 * (above - below));
  rig.scene.boxes[0] = {"table", make_pose({0.7, -0.5, 0.3}), {0.6, 0.6, 0.6}, two.has_table};
  rig.start(ActionKind::receive);
  return made;
}

/// Returns whether the hand that reaches the object is above.
bool reaches_from_above(Rig& rig) {
  rig.run_until("reaching the object");
  rig.cycle();
  EXPECT_EQ(phase_text(rig.planner.status()), "reaching the object") << rig.planner.status().reason;
  return rig.tool().translation().z() > rig.scene.objects[0].T_world_object.translation().z();
}

bool takes_from_above(const TwoGrasps& two) { return reaches_from_above(*receiving(two)); }

TEST(ManipulationPlanner, what_is_taken_can_be_put_down_where_that_is_possible_at_all) {
  for (const bool somewhere : {true, false}) {
    TwoGrasps two;
    two.has_table = somewhere;
    two.settings.place_patience = 0;
    const std::unique_ptr<Rig> rig = receiving(two);
    EXPECT_EQ(reaches_from_above(*rig), somewhere)
        << "the hand below it is nearer, and cannot put it on a table";
    rig->run(30);
    EXPECT_EQ(rig->planner.status().state, ActionState::succeeded) << rig->planner.status().reason;
  }
}

TEST(ManipulationPlanner, for_a_while_no_grasp_is_used_by_which_it_cannot_be_put_down) {
  TwoGrasps two;
  two.has_table = true;
  two.settings.place_detour = 0;
  EXPECT_TRUE(takes_from_above(two));
  two.settings.place_patience = 0;
  EXPECT_FALSE(takes_from_above(two)) << "the hand below it is nearer";
}

TEST(ManipulationPlanner, a_grip_that_may_slip_is_used_only_after_a_while) {
  const double slips = rig::settings().min_sure_margin - 0.01;
  const std::unique_ptr<Rig> rig = receiving({.margin_below = slips, .margin_above = slips});
  rig->run(0.9 * rig::settings().place_patience);
  EXPECT_EQ(std::count(rig->phases.begin(), rig->phases.end(), "approach"), 0);
  EXPECT_FALSE(rig->planner.status().refusals.empty());
  EXPECT_FALSE(reaches_from_above(*rig)) << "the hand below it is nearer";
}

TEST(ManipulationPlanner, what_nobody_offers_is_not_taken) {
  Rig rig;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.draw_back();
  rig.start(ActionKind::receive);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "anna does not offer mug within 30 s");
  EXPECT_EQ(rig.phases, std::vector<std::string>{"clear the offer area"}) << "it moved toward them";
}

TEST(ManipulationPlanner, who_was_asked_for_it_offers_it_with_a_bent_arm_too) {
  Rig rig;
  rig.hold_out();
  rig.facts.facts.clear();
  rig.start(ActionKind::receive);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ManipulationPlanner, an_offer_whose_measure_trembles_does_not_end) {
  Rig rig;
  rig.moves = true;
  rig.speed_scale = 0.15;
  rig.hold_out();
  rig.facts.facts.clear();
  Vector3 p_mug{0.995, 0.1, 1.1};  // 3 cm beyond the min extension
  rig.scene.objects[0].T_world_object.translation() = p_mug;
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  ASSERT_EQ(phase_text(rig.planner.status()), "approach");
  for (int i = 0; phase_text(rig.planner.status()) == "approach" && i < 1000; ++i) {
    rig.scene.objects[0].T_world_object.translation().x() = p_mug.x() + (i % 2 == 0 ? 0.02 : 0.03);
    rig.cycle();
    EXPECT_TRUE(rig.planner.status().exchange_engaged) << "in cycle " << i;
  }
  EXPECT_NE(phase_text(rig.planner.status()), "watching for an offer");
  EXPECT_TRUE(rig.planner.status().refusals.empty())
      << rig.planner.status().refusals.front().reason;
}

TEST(ManipulationPlanner, an_offer_that_is_shifted_is_followed_while_the_arm_moves) {
  Rig rig;
  rig.moves = true;
  rig.speed_scale = 0.15;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  ASSERT_EQ(phase_text(rig.planner.status()), "approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.scene.objects[0].T_world_object.translation().y() += 0.03;
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_GT(rig.led_over, 0) << "nobody asked for a way to where it is now";
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 0);
}

TEST(ManipulationPlanner, foresees_when_the_object_changes_hands) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  double at_first = 0, closed_at = 0, foreseen_at = 0;
  for (int i = 0; i < 1500 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    const double left = rig.planner.status().time_to_handover,
                 now = to_seconds(rig.now.time_since_epoch());
    const std::string phase = phase_text(rig.planner.status());
    const bool waits = phase == "watching for an offer" || phase == "clear the offer area";
    EXPECT_FALSE(waits && std::isfinite(left)) << phase;
    if (phase == "approach" && std::isfinite(left) && at_first == 0) {
      at_first = left;
      foreseen_at = now + left;
    }
    if (phase == "grasp" && closed_at == 0) closed_at = now;
  }
  ASSERT_GT(at_first, 0.5);
  ASSERT_GT(closed_at, 0);
  EXPECT_NEAR(foreseen_at, closed_at, 2.0);
  EXPECT_FALSE(std::isfinite(rig.planner.status().time_to_handover)) << "it is over";
}

TEST(ManipulationPlanner, what_is_put_into_the_open_hand_on_its_way_is_held_at_once) {
  Rig rig;
  rig.moves = true;
  rig.speed_scale = 0.15;
  rig.hold_out();
  Vector grasping = rig.q;
  grasping[rig.robot->require_group("arm").axes.front()] += 0.2;  // as the rig answers
  rig.T_tool_mug =
      (rig.scene.T_world_base * rig.robot->link_pose(grasping, rig.robot->tool_link())).inverse() *
      rig.scene.objects[0].T_world_object;
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.scene.objects[0].holder = Holder::robot;
  rig.facts.facts.clear();
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "reaching the object"), 0);
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "retreat from a person"), 0);
}

TEST(ManipulationPlanner, what_is_drawn_back_is_not_gone_after) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.draw_back();
  rig.run_until("watching for an offer");
  EXPECT_EQ(phase_text(rig.planner.status()), "watching for an offer");
  ASSERT_FALSE(rig.planner.status().refusals.empty());
  EXPECT_EQ(rig.planner.status().refusals.back().reason, "anna has drawn mug back");
}

TEST(ManipulationPlanner, who_steps_toward_the_hand_that_is_near_is_stepped_back_from) {
  Rig rig;
  rig.moves = true;
  rig.speed_scale = 0.15;
  rig.hold_out();
  rig.scene.objects[0].T_world_object.translation() =
      rig.tool().translation() + Vector3(0.35, 0, 0);
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  const auto step = [&rig](double speed) {
    for (BodyJoint& joint : rig.people.people.front().joints) joint.velocity = {-speed, 0, 0};
    for (int i = 0; i < 5; ++i) rig.cycle();
  };
  step(0.2);
  EXPECT_EQ(phase_text(rig.planner.status()), "approach") << "they only sway";
  EXPECT_EQ(rig.phases, std::vector<std::string>{"approach"});
  step(1.0);
  step(0.0);
  rig.run_until("reaching the object");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "stepping back"), 1);
  EXPECT_EQ(phase_text(rig.planner.status()), "reaching the object")
      << "it comes again: " << rig.planner.status().reason;
}

TEST(ManipulationPlanner, people_beside_the_arm_offer_toward_the_hand_and_need_room_there) {
  Rig rig;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.draw_back();
  for (BodyJoint& joint : rig.people.people.front().joints) joint.position.y() += 0.5;
  rig.scene.objects[0].T_world_object.translation().y() += 0.5;
  rig.start(ActionKind::receive);
  rig.run(10);
  EXPECT_EQ(rig.phases, std::vector<std::string>{"clear the offer area"});
}

TEST(ManipulationPlanner, the_arm_before_the_giver_makes_room_first_then_the_other_one) {
  for (const double side : {1.0, -1.0}) {
    Rig rig("duo");
    rig.scene.objects[0].holder = Holder::human;
    rig.scene.objects[0].holder_id = "anna";
    rig.draw_back();
    for (BodyJoint& joint : rig.people.people.front().joints) joint.position.y() += 0.4 * side;
    rig.scene.objects[0].T_world_object.translation().y() += 0.4 * side;
    rig.start(ActionKind::receive);
    rig.run_until("clear the offer area");
    ASSERT_EQ(phase_text(rig.planner.status()), "clear the offer area");
    rig.run(2);
    const std::vector<std::string> left_first{"left_arm", "arm"}, right_first{"arm", "left_arm"};
    EXPECT_EQ(rig.path_groups, side > 0 ? left_first : right_first)
        << "people hold back before whichever hand is the nearest";
  }
}

TEST(ManipulationPlanner, room_is_made_only_until_there_is_an_offer) {
  Rig rig;
  rig.moves = true;
  rig.speed_scale = 0.02;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.draw_back();
  rig.start(ActionKind::receive);
  rig.run_until("clear the offer area");
  ASSERT_EQ(phase_text(rig.planner.status()), "clear the offer area");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.hold_out();
  for (int i = 0; i < 50 && phase_text(rig.planner.status()) == "clear the offer area"; ++i)
    rig.cycle();
  EXPECT_NE(phase_text(rig.planner.status()), "clear the offer area")
      << "it goes all the way though she waits";
}

TEST(ManipulationPlanner, where_fingers_are_in_the_way_of_the_hand_it_does_not_go) {
  Rig rig;
  rig.hold_out();
  Person& anna = rig.people.people.front();
  rig.start(ActionKind::receive);
  for (int i = 0; i < 3000 && rig.planner.status().state != ActionState::failed; ++i) {
    Vector at = rig.q;
    at[rig.robot->require_group("arm").axes.front()] += 0.2;  // as the rig answers
    const Vector3 p = rig.robot->link_pose(at, rig.robot->tool_link()).translation();
    for (const char* joint : {"r_hand", "r_wrist"})
      anna.joints[static_cast<std::size_t>(body_joint_index(joint))].position = p;
    rig.cycle();
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "the hand would come too near to the fingers of anna");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "approach"), 0);
}

TEST(ManipulationPlanner, from_an_offer_that_is_moved_away_it_backs_off_with_the_hand_opened) {
  Rig rig;
  rig.moves = true;
  ASSERT_TRUE(receive_until(rig, "reaching the object"));
  for (int i = 0; i < 10; ++i) rig.cycle();
  rig.draw_back();
  rig.run_until("watching for an offer");
  EXPECT_EQ(phase_text(rig.planner.status()), "watching for an offer");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 1);
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  EXPECT_FALSE(rig.planner.status().holding);
  ASSERT_FALSE(rig.planner.status().refusals.empty());
  EXPECT_EQ(rig.planner.status().refusals.back().reason, "mug was moved away");
}

TEST(ManipulationPlanner, a_grasp_whose_hand_pushes_the_object_away_is_not_tried_again) {
  Rig rig;
  rig.moves = true;
  ASSERT_TRUE(receive_until(rig, "reaching the object"));
  for (int i = 0; i < 10; ++i) rig.cycle();
  const Pose T_offered = rig.scene.objects[0].T_world_object;
  rig.scene.objects[0].T_world_object.translation().z() -= 0.03;
  rig.run_until("backing off");
  ASSERT_EQ(phase_text(rig.planner.status()), "backing off");
  rig.scene.objects[0].T_world_object = T_offered;
  rig.run(3);
  const auto& refusals = rig.planner.status().refusals;
  const bool is_refused = std::any_of(refusals.begin(), refusals.end(), [](const auto& refusal) {
    return refusal.reason == "the hand pushes mug away";
  });
  EXPECT_TRUE(is_refused);
}

TEST(ManipulationPlanner, an_unsure_grip_does_not_open_on_what_the_giver_has_released) {
  for (const bool released : {true, false}) {
    Rig rig;
    rig.unsure = true;
    rig.object_comes = released;
    rig.hold_out();
    rig.start(ActionKind::receive);
    rig.run(200);
    EXPECT_EQ(rig.planner.status().state, released ? ActionState::succeeded : ActionState::failed)
        << rig.planner.status().reason;
    EXPECT_EQ(rig.planner.status().holding, released);
    EXPECT_EQ(rig.phases.back(), released ? "retreat" : "backing off");
    EXPECT_EQ(rig.planner.status().reason, released ? "" : "the hand did not get hold of it");
  }
}

TEST(ManipulationPlanner, a_sure_grip_does_not_open_on_what_nobody_else_holds) {
  Rig rig;
  rig.object_comes = false;
  ASSERT_TRUE(receive_until(rig, "waiting for release"));
  rig.scene.objects[0].holder = Holder::nobody;
  rig.scene.objects[0].holder_id.clear();
  rig.run(200);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 0);
}

TEST(ManipulationPlanner, what_the_giver_leaves_in_the_hand_on_a_surface_is_lifted) {
  for (const bool unsure : {true, false})
    for (const bool comes : {true, false}) {
      Rig rig;
      rig.moves = true;
      rig.unsure = unsure;
      rig.object_comes = false;
      ASSERT_TRUE(receive_until(rig, "waiting for release"));
      rig.scene.objects[0].holder = Holder::surface;
      rig.scene.objects[0].holder_id = "table";
      rig.run_until("lift");
      ASSERT_EQ(phase_text(rig.planner.status()), "lift");
      if (comes) rig.scene.objects[0].holder = Holder::robot;
      rig.run(200);
      EXPECT_EQ(rig.planner.status().holding, comes) << rig.planner.status().reason;
      EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), comes ? 0 : 1);
      if (comes) continue;
      EXPECT_EQ(rig.planner.status().reason, "mug stayed behind when the hand went up");
    }
}

TEST(ManipulationPlanner, a_grip_that_bears_the_load_is_worth_a_longer_motion) {
  TwoGrasps two;
  two.settings.place_patience = 0;
  EXPECT_FALSE(takes_from_above(two)) << "the hand below it is nearer";
  two.margin_below = -3.0;
  EXPECT_TRUE(takes_from_above(two));
}

TEST(ManipulationPlanner, a_grip_that_may_slip_is_tried_last) {
  TwoGrasps two;
  two.settings.place_patience = 0;
  const double least = two.settings.min_sure_margin, slips = least - 0.01;
  two.margin_below = two.margin_above = least + 0.01;
  EXPECT_FALSE(takes_from_above(two)) << "the hand below it is nearer";
  two.margin_below = slips;
  EXPECT_TRUE(takes_from_above(two));
  two.margin_above = slips;
  EXPECT_FALSE(takes_from_above(two));
}

TEST(ManipulationPlanner, who_does_not_let_go_keeps_it) {
  Rig rig;
  rig.object_comes = false;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run(200);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "anna does not release mug");
  EXPECT_EQ(rig.phases.back(), "backing off");
  EXPECT_FALSE(rig.planner.status().holding);
}

}  // namespace
}  // namespace handsel::manipulation_planner::receive_test
