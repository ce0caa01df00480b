// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/placing/place_search.hpp"
#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::manipulation_planner_test {
namespace {

using rig::Rig;

TEST(ManipulationPlanner, the_hand_opens_on_its_way_which_is_planned_for_it_opened) {
  Rig rig;
  rig.moves = true;
  rig.opens_for = 20;
  rig.opens_by = 0.1;
  const double closed = RobotModel::part(rig.q, rig.robot->require_group("hand"))[0];
  rig.start(ActionKind::pick);
  rig.run_until("approach");
  ASSERT_EQ(phase_text(rig.planner.status()), "approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  EXPECT_EQ(rig.execution.motion, MotionState::running);
  EXPECT_EQ(rig.execution.hand, HandState::moving);
  EXPECT_NEAR(RobotModel::part(rig.last_path.start, rig.robot->require_group("hand"))[0],
              closed + 0.1, 1e-9);
  rig.opening = 200;
  for (int i = 0; i < 150; ++i) rig.cycle();
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "reaching the object"), 0)
      << "with the hand half open";
  rig.run_until("reaching the object");
  EXPECT_EQ(rig.execution.hand, HandState::idle);
}

TEST(ManipulationPlanner, picks_by_approach_reach_grasp_and_lift) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"approach", "reaching the object", "lift"}));
}

TEST(ManipulationPlanner, a_motion_that_is_held_back_again_and_again_is_planned_anew) {
  Rig rig;
  rig.moves = true;
  rig.start(ActionKind::pick);
  rig.run_until("approach");
  const auto blocked = [&] {
    const auto& refusals = rig.planner.status().refusals;
    return std::any_of(refusals.begin(), refusals.end(), [](const Refusal& r) {
      return r.reason.starts_with("the path is blocked");
    });
  };
  const double along = rig.along;
  for (int i = 0; i < 200 && !blocked(); ++i) {
    rig.execution.causes = i % 20 < 4 ? 1U << static_cast<unsigned>(Cause::forecast_collision) : 0U;
    rig.along = along;  // the motion starts and never ends
    rig.cycle();
  }
  EXPECT_TRUE(blocked());
}

TEST(ManipulationPlanner, the_object_rises_when_lifted) {
  Rig rig;
  rig.start(ActionKind::pick);
  double before = 0;
  for (int i = 0; i < 1500 && rig.planner.status().state == ActionState::running; ++i) {
    if (phase_text(rig.planner.status()) == "grasp") before = rig.tool().translation().z();
    rig.cycle();
  }
  EXPECT_GT(rig.tool().translation().z() - before, 0.1);
}

TEST(ManipulationPlanner, gives_within_reach_of_the_person_and_engages_them_only_at_the_offer) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.start(ActionKind::give);
  bool engaged_before_offer = false, engaged_at_offer = false;
  for (int i = 0; i < 2000 && (i < 5 || rig.planner.status().state == ActionState::running); ++i) {
    const ActionStatus& status = rig.planner.status();
    if (phase_text(status) == "carry") engaged_before_offer |= status.exchange_engaged;
    if (phase_text(status) == "offer") engaged_at_offer |= status.exchange_engaged;
    rig.cycle();
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_FALSE(engaged_before_offer);
  EXPECT_TRUE(engaged_at_offer);
  EXPECT_TRUE(within_reach(rig.people.people[0], rig.planner.status().exchange_point));
  EXPECT_FALSE(rig.planner.status().holding);
  EXPECT_EQ(rig.phases.back(), "retreat");
  EXPECT_NE(std::find(rig.allowed.back().begin(), rig.allowed.back().end(), "anna"),
            rig.allowed.back().end());
}

TEST(ManipulationPlanner, an_offer_nobody_takes_fails_with_their_name) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.person_takes = false;
  rig.start(ActionKind::give);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_NE(rig.planner.status().reason.find("anna did not take mug"), std::string::npos)
      << rig.planner.status().reason;
  EXPECT_TRUE(rig.planner.status().holding);
}

TEST(ManipulationPlanner, offers_elsewhere_or_turned_after_an_offer_that_nobody_took) {
  for (const double weight : {1.0, 0.0}) {
    SCOPED_TRACE(weight);
    auto settings = rig::settings();
    settings.w_vain_offer = weight;
    Rig rig("jido", settings);
    rig.start(ActionKind::pick);
    rig.run(30);
    rig.person_takes = false;
    const auto offered = [&]() -> Pose {
      rig.start(ActionKind::give);
      rig.run_until("offer");
      EXPECT_EQ(phase_text(rig.planner.status()), "offer");
      const Pose T_world_mug = rig.scene.objects[0].T_world_object;
      rig.run(60);
      EXPECT_EQ(rig.planner.status().state, ActionState::failed);
      return T_world_mug;
    };
    const Pose first = offered(), second = offered();
    const Eigen::Matrix3d R = first.linear().transpose() * second.linear();
    const bool is_near =
        (first.translation() - second.translation()).norm() < 0.9 * settings.vain_offer_range &&
        Eigen::AngleAxisd(R).angle() < 0.9 * settings.vain_offer_turn;
    EXPECT_EQ(is_near, weight == 0.0);
  }
}

TEST(ManipulationPlanner, what_a_person_has_drawn_out_of_the_closed_hand_is_given) {
  Rig rig;
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.person_takes = false;  // no pull is measured
  rig.start(ActionKind::give);
  rig.run_until("offer");
  SceneObject& mug = rig.scene.objects[0];
  mug.holder = Holder::human;
  mug.holder_id = "anna";
  mug.T_world_object.translation() += Vector3(0.3, 0, 0);
  rig.run(5);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_FALSE(rig.planner.status().holding);
}

TEST(ManipulationPlanner, a_person_at_the_far_end_of_something_long_has_taken_hold_of_it) {
  for (const bool is_long : {true, false}) {
    SCOPED_TRACE(is_long);
    Rig rig;
    if (is_long) rig.mug.parts.push_back({Box{{0.05, 0.05, 0.6}}, Pose::Identity()});
    rig.start(ActionKind::pick);
    rig.run(30);
    rig.phases.clear();
    const Pose T_world_mug = rig.scene.objects[0].T_world_object;
    const auto hand = static_cast<std::size_t>(body_joint_index("r_hand"));
    rig.people.people[0].joints[hand].position = T_world_mug * Vector3(0.03, 0, 0.25);
    rig.person_takes = false;
    rig.start(ActionKind::give);
    for (int i = 0; i < 10; ++i) rig.cycle();
    EXPECT_EQ(phase_text(rig.planner.status()), "offer");
    EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "carry"), is_long ? 0 : 1);
  }
}

TEST(ManipulationPlanner, an_opening_that_a_stop_interrupts_depends_on_whose_hand_has_the_object) {
  enum class Has { person, robot, nobody_surely };
  for (const Has who : {Has::person, Has::robot, Has::nobody_surely}) {
    SCOPED_TRACE(static_cast<int>(who));
    Rig rig;
    rig.start(ActionKind::pick);
    rig.run(30);
    rig.person_takes = false;
    rig.start(ActionKind::give);
    rig.run_until("offer");
    for (int i = 0; i < 5; ++i) rig.cycle();
    ASSERT_EQ(rig.hand_actions.back(), HandAction::release_on_pull);
    rig.hand_actions.clear();
    if (who == Has::person) {
      rig.scene.objects[0].holder = Holder::human;
      rig.scene.objects[0].holder_id = "anna";
    }
    rig.grasp_holds = who == Has::robot;  // else the hand closes without contact
    rig.execution.hand = HandState::refused;
    for (int i = 0; i < 50; ++i) rig.cycle();
    if (who == Has::robot) {
      EXPECT_EQ(rig.hand_actions, (std::vector{HandAction::grasp, HandAction::release_on_pull}));
      EXPECT_EQ(phase_text(rig.planner.status()), "offer");
      EXPECT_TRUE(rig.planner.status().holding);
      continue;
    }
    EXPECT_EQ(rig.hand_actions.back(), HandAction::release);
    EXPECT_EQ(rig.hand_actions.size(), who == Has::person ? 1u : 2u);
    rig.run(5);
    EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
    EXPECT_FALSE(rig.planner.status().holding);
  }
}

TEST(ManipulationPlanner, a_motion_that_is_stopped_is_planned_again) {
  Rig rig;
  rig.stops = 2;
  rig.start(ActionKind::go_to);
  rig.run(30);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_EQ(rig.path_requests, 3);
}

TEST(ManipulationPlanner, from_a_person_it_touches_it_draws_back_first) {
  Rig rig;
  rig.touched = "anna";
  rig.touching_posture = rig.q;
  const Vector3 torso =
      rig.people.people[0].joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const double before = (rig.tool().translation() - torso).norm();
  rig.start(ActionKind::go_to);
  double farthest = before;
  for (int i = 0; i < 500 && (i < 5 || rig.planner.status().state == ActionState::running); ++i) {
    rig.cycle();
    farthest = std::max(farthest, (rig.tool().translation() - torso).norm());
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_EQ(rig.phases, (std::vector<std::string>{"retreat from a person", "to rest"}));
  EXPECT_EQ(rig.allowed.front(), std::vector<std::string>{"anna"});
  EXPECT_TRUE(rig.allowed.back().empty());
  EXPECT_GT(farthest, before + 0.03);
}

TEST(ManipulationPlanner, a_kept_path_is_timed_anew_when_people_come_near_and_when_they_leave) {
  Rig rig;
  rig.people.people.clear();
  rig.scene.boxes.clear();
  rig.scene.objects.clear();
  rig.moves = true;
  rig.q[rig.robot->require_group("arm").axes[0]] += 2.2;
  rig.start(ActionKind::go_to);
  const auto left = [&] { return rig.way.duration() - rig.along; };
  const int turning = rig.robot->require_group("arm").axes[0];
  const auto runs = [&](double duration) {
    for (double t = 0; t < duration && (rig.way.size() == 0 || left() > 0.02); t += 0.02) {
      const double at = rig.q[turning];
      rig.cycle();
      EXPECT_LT(rig.q[turning], at + 1e-6) << "the arm turned back";
    }
  };
  runs(1.0);
  EXPECT_EQ(rig.commands.size(), 1u);
  EXPECT_GT(rig.planner.replan_counts().unchanged, 1u);
  EXPECT_EQ(rig.planner.replan_counts().retimed, 0u);
  const double before = left();
  rig.speed_scale = 0.5;  // a person is near
  runs(0.6);
  const auto& counts = rig.planner.replan_counts();
  ASSERT_EQ(rig.commands.size(), 2u)
      << counts.checks << " checks, " << counts.refused << " refused";
  EXPECT_GT(left() + 0.6, before + 0.15);
  rig.speed_scale = 0.97;  // and has left
  const double slow = left();
  EXPECT_GT(slow, 1.5) << "the test needs a longer way";
  runs(0.6);
  ASSERT_EQ(rig.commands.size(), 3u)
      << counts.checks << " checks, " << counts.refused << " refused";
  EXPECT_LT(left() + 0.6, slow - 0.08);
  EXPECT_EQ(rig.planner.replan_counts().retimed, 2u);
  for (const double jump : rig.jumps) EXPECT_LT(jump, 1e-9);
  runs(20);
  EXPECT_EQ(rig.commands.size(), 3u);
  rig.run(1);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ManipulationPlanner,
     a_motion_reported_under_another_number_is_stopped_before_the_next_attempt) {
  Rig rig;
  rig.people.people.clear();
  rig.scene.boxes.clear();
  rig.scene.objects.clear();
  rig.moves = true;
  rig.q[rig.robot->require_group("arm").axes[0]] += 1.0;
  rig.start(ActionKind::go_to);
  while (rig.commands.empty()) rig.cycle();
  for (int k = 0; k < 20; ++k) rig.cycle();
  rig.execution.trajectory = 999;  // and the arm continues
  rig.execution.motion = MotionState::refused;
  const std::size_t before = rig.commands.size();
  rig.run(30);
  ASSERT_GT(rig.commands.size(), before);
  EXPECT_TRUE(rig.commands[before].axes.empty()) << "a stop, before anything else";
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ManipulationPlanner, says_what_stood_in_the_way_and_what_it_tried) {
  Rig rig;
  rig.failing_paths = 1000;
  rig.start(ActionKind::go_to);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_NE(rig.planner.status().reason.find("forearm"), std::string::npos);
  EXPECT_FALSE(rig.planner.status().refusals.empty());
}

TEST(ManipulationPlanner, no_grasps_is_a_reason_not_a_crash) {
  Rig rig;
  rig.grasps_exist = false;
  rig.fails_to_pick("three contacts");
}

TEST(ManipulationPlanner, a_dead_planner_is_asked_again_and_named_in_the_end) {
  Rig rig;
  rig.grasp_planner_lives = false;
  rig.fails_to_pick("grasp planner", ActionFailure::no_answer);
}

TEST(ManipulationPlanner, an_empty_hand_backs_off_and_says_so) {
  Rig rig;
  rig.grasp_holds = false;
  rig.fails_to_pick("closed on nothing", ActionFailure::nothing_grasped);
  EXPECT_EQ(rig.phases.back(), "backing off");
}

TEST(ManipulationPlanner, what_stays_behind_when_the_hand_goes_up_is_not_held) {
  Rig rig;
  rig.object_comes = false;
  rig.fails_to_pick("stayed behind", ActionFailure::left_behind);
  EXPECT_FALSE(rig.planner.status().holding);
  EXPECT_GT(std::count(rig.phases.begin(), rig.phases.end(), "lift"), 1) << "it is tried again";
}

TEST(ManipulationPlanner, what_slips_out_of_the_hand_ends_the_action_with_that_reason) {
  for (const bool to_a_person : {false, true}) {
    Rig rig;
    rig.start(ActionKind::pick);
    rig.run(30);
    ASSERT_TRUE(rig.planner.status().holding);
    rig.person_takes = false;
    rig.start(ActionKind::give);
    rig.run_until("offer");
    SceneObject& mug = rig.scene.objects[0];
    mug.holder = to_a_person ? Holder::human : Holder::nobody;
    mug.holder_id = to_a_person ? "anna" : "";
    mug.T_world_object.translation().z() = 0.05;
    for (int i = 0; i < 20; ++i) rig.cycle();
    const ActionStatus& status = rig.planner.status();
    if (to_a_person) {
      EXPECT_NE(status.state, ActionState::failed) << status.reason;
      continue;
    }
    EXPECT_EQ(status.state, ActionState::failed);
    EXPECT_EQ(status.reason, "mug slipped out of the hand (offer)");
    EXPECT_FALSE(status.holding);
  }
}

TEST(ManipulationPlanner,
     cancelled_in_mid_motion_it_says_so_stops_the_arm_and_takes_the_next_action) {
  Rig rig;
  rig.moves = true;
  rig.q[rig.robot->require_group("arm").axes[0]] += 1.0;
  rig.start(ActionKind::go_to);
  for (int i = 0; i < 50 && rig.commands.empty(); ++i) rig.cycle();
  for (int i = 0; i < 5; ++i) rig.cycle();
  ASSERT_EQ(rig.commands.size(), 1u);
  ActionGoal cancel;
  cancel.id = rig.actions;
  cancel.cancel = true;
  rig.planner.on(cancel);
  EXPECT_EQ(rig.planner.status().state, ActionState::cancelled);
  rig.execution.mode = Mode::hold;
  for (int i = 0; i < 20; ++i) rig.cycle();
  ASSERT_EQ(rig.commands.size(), 2u) << "heard once is enough";
  EXPECT_TRUE(rig.commands.back().axes.empty());
  rig.execution.mode = Mode::normal;
  rig.start(ActionKind::go_to);
  rig.run(10);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded);
}

TEST(ManipulationPlanner, with_the_action_goes_what_it_has_asked_the_path_planner_for) {
  for (const bool replaced : {false, true}) {
    Rig rig;
    rig.path_planner_lives = false;
    rig.start(ActionKind::go_to);
    rig.run(0.5);
    const RequestId asked = rig.last_path.id;
    ASSERT_FALSE(rig.last_path.cancel);
    if (replaced) {
      rig.execution.mode = Mode::hold;  // so that the next action sends no request yet
      rig.start(ActionKind::go_to);
    } else {
      ActionGoal cancel;
      cancel.id = rig.actions;
      cancel.cancel = true;
      rig.planner.on(cancel);
    }
    rig.cycle();
    EXPECT_TRUE(rig.last_path.cancel);
    EXPECT_EQ(rig.last_path.id, asked);
    rig.last_path = {};
    rig.cycle();
    EXPECT_FALSE(rig.last_path.cancel) << "once is enough";
  }
  Rig rig;
  rig.start(ActionKind::go_to);
  rig.run(10);
  ASSERT_EQ(rig.planner.status().state, ActionState::succeeded);
  rig.start(ActionKind::go_to);
  rig.execution.mode = Mode::hold;
  rig.cycle();
  EXPECT_FALSE(rig.last_path.cancel) << "all was answered";
}

TEST(ManipulationPlanner, places_what_it_holds_on_the_surface) {
  Rig rig;
  Vector at_grasp = rig.q;  // as the rig answers
  at_grasp[rig.robot->require_group("arm").axes[0]] += 0.2;
  const Vector3 mug =
      rig.robot->link_pose(at_grasp, rig.robot->tool_link()).translation() - Vector3(0, 0, 0.3);
  rig.scene.objects[0].T_world_object = make_pose(mug);
  rig.grasped_as_it_stands = true;
  rig.scene.boxes[0] = {
      "table", make_pose({mug.x(), mug.y(), mug.z() - 0.16}), {0.5, 0.5, 0.1}, true};
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.start(ActionKind::place);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_FALSE(rig.planner.status().holding);
}

/// Returns how high above a table a mug is released whose origin is `below` the hand [m]; negative:
/// the mug cannot be put down.
double release_height(double below) {
  constexpr double kHalfTable = 0.05;
  Rig rig;
  Vector at_grasp = rig.q;  // as the rig answers
  at_grasp[rig.robot->require_group("arm").axes[0]] += 0.2;
  const Vector3 mug =
      rig.robot->link_pose(at_grasp, rig.robot->tool_link()).translation() - Vector3(0, 0, below);
  rig.scene.objects[0].T_world_object = make_pose(mug);
  rig.grasped_as_it_stands = true;
  const Vector3 table = mug - Vector3(0, 0, 0.16);
  rig.scene.boxes[0] = {"table", make_pose(table), {0.5, 0.5, 2 * kHalfTable}, true};
  rig.start(ActionKind::pick);
  rig.run(30);
  rig.start(ActionKind::place);
  double lowest = 1e9;
  for (int i = 0; i < 3000 && rig.planner.status().state == ActionState::running; ++i) {
    rig.cycle();
    if (rig.planner.status().holding)
      lowest = std::min(lowest, rig.scene.objects[0].T_world_object.translation().z());
  }
  if (rig.planner.status().state != ActionState::succeeded) return -1;
  return lowest - table.z() - kHalfTable - rig.mug.height_above_support;
}

TEST(ManipulationPlanner, a_hand_that_reaches_below_what_it_holds_releases_it_a_little_higher) {
  EXPECT_NEAR(release_height(0.3), kAbovePlace, 1e-3);
  double highest = -1;
  for (double below = 0.2; below > 0; below -= 0.005)
    highest = std::max(highest, release_height(below));
  EXPECT_NEAR(highest, kAbovePlace + 0.008, 1e-3);
}

TEST(ManipulationPlanner, what_the_holding_arm_cannot_put_down_goes_to_the_other_hand) {
  Rig rig("duo");
  rig.scene.objects[0].holder = Holder::robot;
  rig.T_tool_mug = make_pose({0.08, 0.02, 0.12});
  // On the left, out of reach of the right arm.
  rig.scene.boxes[0] = {"table", make_pose({0.5, 0.9, 0.5}), {0.5, 0.5, 1.0}, true};
  rig.start(ActionKind::place);
  rig.run(30);
  ASSERT_EQ(rig.regrasps.size(), 1U) << rig.planner.status().reason;
  const RegraspRequest& asked = rig.regrasps.front();
  EXPECT_EQ(asked.holder, "arm");
  EXPECT_TRUE(asked.grasp.T_object_hand.isApprox(rig.T_tool_mug.inverse(), 1e-6));
  EXPECT_FALSE(asked.both);
  ASSERT_FALSE(asked.goals.empty());
  for (const StandingPlace& place : asked.goals) {
    const Vector3 p = place.T_world_object.translation();
    EXPECT_LT(std::abs(p.x() - 0.5), 0.25);
    EXPECT_LT(std::abs(p.y() - 0.9), 0.25);
    EXPECT_GT(p.z(), 1.0);
    EXPECT_GT(place.T_world_object.linear()(2, 2), 0.999) << "upright";
  }
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  const std::string& reason = rig.planner.status().reason;
  EXPECT_NE(reason.find("no free place on table within the reach of the arm"), std::string::npos)
      << reason;
  EXPECT_NE(reason.find("by a change of hands: no sequence of grasps"), std::string::npos)
      << reason;
}

TEST(ManipulationPlanner, what_has_no_model_is_not_passed_on_and_that_is_the_reason) {
  Rig rig("duo");
  rig.scene.objects[0].holder = Holder::robot;
  rig.scene.objects[0].model = "unknown_thing";
  rig.T_tool_mug = make_pose({0.08, 0.02, 0.12});
  rig.start(ActionKind::regrasp);
  rig.run(5);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_EQ(rig.planner.status().reason, "object mug has no model");
}

TEST(ManipulationPlanner, at_rest_a_hand_beside_another_folds_its_fingers) {
  for (const std::string robot : {"duo", "jido"})
    for (const double opened : {0.0, 0.3}) {
      Rig rig(robot);
      rig.people.people.clear();
      rig.q = rig.robot->rest_configuration();
      rig.q[rig.robot->require_group("hand").axes.front()] += opened;
      rig.start(ActionKind::go_to);
      rig.run(30);
      EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
      const bool folds = robot == "duo" && opened > 0;
      EXPECT_EQ(rig.hand_actions, folds ? std::vector{HandAction::move} : std::vector<HandAction>{})
          << robot << " opened by " << opened;
    }
}

TEST(ManipulationPlanner, one_arm_alone_asks_no_other_hand) {
  Rig rig;
  rig.scene.objects[0].holder = Holder::robot;
  rig.T_tool_mug = make_pose({0.08, 0.02, 0.12});
  rig.scene.boxes[0] = {"table", make_pose({2.5, 0.9, 0.5}), {0.5, 0.5, 1.0}, true};
  rig.start(ActionKind::place);
  rig.run(30);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_TRUE(rig.regrasps.empty());
}

}  // namespace
}  // namespace handsel::manipulation_planner::manipulation_planner_test
