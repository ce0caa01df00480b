// Receiving: what is held out is taken, what is drawn back is not gone after.
#include "tests/unit/manipulation_rig.hpp"

namespace handsel::manipulation_planner {
namespace {

using rig::Rig;

TEST(ManipulationPlanner, TakesWhatAPersonHoldsOutAndEngagesThemOnlyWhileTheyOffer) {
  Rig rig;
  rig.start(ActionKind::receive);
  rig.run(1);
  EXPECT_EQ(rig.planner.status().phase, "watching for an offer");
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  rig.hold_out();
  bool engaged = false;
  for (int i = 0; i < 1000 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    if (rig.planner.status().phase == "reaching the object") engaged = rig.planner.status().exchange_engaged;
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(engaged);
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"approach", "reaching the object", "retreat"}));
}

TEST(ManipulationPlanner, WhatNobodyOffersIsNotTaken) {
  Rig rig;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.draw_back();
  rig.start(ActionKind::receive);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "anna does not offer mug within 30 s");
  EXPECT_EQ(rig.phases, std::vector<std::string>{"making room"}) << "it moved toward them";
}

TEST(ManipulationPlanner, WhoWasAskedForItOffersItWithABentArmToo) {
  Rig rig;
  rig.hold_out();
  rig.facts.facts.clear();
  rig.start(ActionKind::receive);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ManipulationPlanner, AnOfferWhoseMeasureTremblesDoesNotEnd) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.15;
  rig.hold_out();
  rig.facts.facts.clear();
  Vector3 p_mug{1.145, 0, 1.1};  // 2.5 cm beyond what is kept before the body
  rig.scene.objects[0].T_world_object.translation() = p_mug;
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  ASSERT_EQ(rig.planner.status().phase, "approach");
  for (int i = 0; rig.planner.status().phase == "approach" && i < 1000; ++i) {
    rig.scene.objects[0].T_world_object.translation().x() = p_mug.x() + (i % 2 == 0 ? 0.02 : 0.03);
    rig.cycle();
    EXPECT_TRUE(rig.planner.status().exchange_engaged) << "in cycle " << i;
  }
  EXPECT_NE(rig.planner.status().phase, "watching for an offer");
  EXPECT_TRUE(rig.planner.status().refusals.empty()) << rig.planner.status().refusals.front().reason;
}

TEST(ManipulationPlanner, AnOfferThatIsShiftedIsFollowedWhileTheArmMoves) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.15;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  ASSERT_EQ(rig.planner.status().phase, "approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.scene.objects[0].T_world_object.translation().y() += 0.03;
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_GT(rig.led_over, 0) << "nobody asked for a way to where it is now";
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 0);
}

TEST(ManipulationPlanner, ForeseesWhenTheObjectChangesHands) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  double at_first = 0, closed_at = 0, foreseen_at = 0;
  for (int i = 0; i < 1500 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    const double left = rig.planner.status().time_to_exchange, now = to_seconds(rig.now.time_since_epoch());
    const std::string& phase = rig.planner.status().phase;
    const bool waits = phase == "watching for an offer" || phase == "making room";
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
  EXPECT_FALSE(std::isfinite(rig.planner.status().time_to_exchange)) << "it is over";
}

TEST(ManipulationPlanner, WhatIsPutIntoTheOpenHandOnItsWayIsHeldAtOnce) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.15;
  rig.hold_out();
  Vector grasping = rig.q;
  grasping[rig.robot->require_group("arm").axes.front()] += 0.2;  // as the rig answers
  rig.T_tool_mug =
      (rig.scene.T_world_base * rig.robot->link_pose(grasping, rig.robot->tool_link())).inverse() * rig.scene.objects[0].T_world_object;
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.scene.objects[0].holder = Holder::robot;
  rig.facts.facts.clear();
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "reaching the object"), 0);
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "drawing back"), 0);
}

TEST(ManipulationPlanner, WhatIsDrawnBackIsNotGoneAfter) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.draw_back();
  rig.run_until("watching for an offer");
  EXPECT_EQ(rig.planner.status().phase, "watching for an offer");
  ASSERT_FALSE(rig.planner.status().refusals.empty());
  EXPECT_EQ(rig.planner.status().refusals.back().reason, "anna has drawn mug back");
}

TEST(ManipulationPlanner, WhoStepsTowardTheHandThatIsNearIsSteppedBackFrom) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.15;
  rig.hold_out();
  rig.scene.objects[0].T_world_object.translation() = rig.tool().translation() + Vector3(0.35, 0, 0);
  rig.start(ActionKind::receive);
  rig.run_until("approach");
  const auto step = [&rig](double speed) {
    for (BodyJoint& joint : rig.people.people.front().joints) joint.velocity = {-speed, 0, 0};
    for (int i = 0; i < 5; ++i) rig.cycle();
  };
  step(0.2);
  EXPECT_EQ(rig.planner.status().phase, "approach") << "they only sway";
  EXPECT_EQ(rig.phases, std::vector<std::string>{"approach"});
  step(1.0);
  step(0.0);
  rig.run_until("reaching the object");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "stepping back"), 1);
  EXPECT_EQ(rig.planner.status().phase, "reaching the object") << "it comes again: " << rig.planner.status().reason;
}

TEST(ManipulationPlanner, RoomIsMadeOnlyUntilThereIsAnOffer) {
  Rig rig;
  rig.moves = true;
  rig.share = 0.02;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.draw_back();
  rig.start(ActionKind::receive);
  rig.run_until("making room");
  ASSERT_EQ(rig.planner.status().phase, "making room");
  for (int i = 0; i < 5; ++i) rig.cycle();
  rig.hold_out();
  for (int i = 0; i < 50 && rig.planner.status().phase == "making room"; ++i) rig.cycle();
  EXPECT_NE(rig.planner.status().phase, "making room") << "it goes all the way though she waits";
}

TEST(ManipulationPlanner, WhereFingersAreInTheWayOfTheHandItDoesNotGo) {
  Rig rig;
  rig.hold_out();
  Person& anna = rig.people.people.front();
  rig.start(ActionKind::receive);
  for (int i = 0; i < 3000 && rig.planner.status().state != ActionState::failed; ++i) {
    Vector at = rig.q;
    at[rig.robot->require_group("arm").axes.front()] += 0.2;  // as the rig answers
    const Vector3 p = rig.robot->link_pose(at, rig.robot->tool_link()).translation();
    for (const char* joint : {"r_hand", "r_wrist"}) anna.joints[static_cast<std::size_t>(body_joint_index(joint))].position = p;
    rig.cycle();
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "the hand would come too near to the fingers of anna");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "approach"), 0);
}

TEST(ManipulationPlanner, FromAnOfferThatIsMovedAwayItBacksOffWithTheHandOpened) {
  Rig rig;
  rig.moves = true;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run_until("reaching the object");
  ASSERT_EQ(rig.planner.status().phase, "reaching the object");
  for (int i = 0; i < 10; ++i) rig.cycle();
  rig.draw_back();
  rig.run_until("watching for an offer");
  EXPECT_EQ(rig.planner.status().phase, "watching for an offer");
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "backing off"), 1);
  EXPECT_FALSE(rig.planner.status().exchange_engaged);
  EXPECT_FALSE(rig.planner.status().holding);
  ASSERT_FALSE(rig.planner.status().refusals.empty());
  EXPECT_EQ(rig.planner.status().refusals.back().reason, "mug was moved away");
}

TEST(ManipulationPlanner, WhoDoesNotLetGoKeepsIt) {
  Rig rig;
  rig.object_comes = false;
  rig.hold_out();
  rig.start(ActionKind::receive);
  rig.run(200);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "anna does not let go of mug");
  EXPECT_EQ(rig.phases.back(), "backing off");
  EXPECT_FALSE(rig.planner.status().holding);
}

}  // namespace
}  // namespace handsel::manipulation_planner
