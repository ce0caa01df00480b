// SPDX-License-Identifier: Apache-2.0
#include "components/attention/attention.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/base/advised_period.hpp"
#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/model/human/body_index.hpp"
#include "components/attention/settings.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::attention::attention_test {
namespace {

using testing::HasSubstr;

TimePoint at(double seconds) { return TimePoint(from_seconds(100.0 + seconds)); }

Person standing(double x, double y, const std::string& id = "anna") {
  Person p;
  p.id = id;
  p.joints = standing_body(Vector3(x, y, 0), M_PI, 1.75);
  return p;
}

void move(Person& p, const Vector3& by, const Vector3& velocity) {
  for (BodyJoint& j : p.joints) {
    j.position += by;
    j.velocity = velocity;
  }
}

AttentionSettings settings(ClockLaw law = ClockLaw::linear) {
  AttentionSettings s;
  s.motor.partner_slow = 0.40;
  s.motor.hand_near = 0.30;
  s.motor.hand_factor = 0.25;
  const auto add = [&](Behaviour b, double p_min, double p_max, double near, double far) {
    s.behaviours.push_back({b, {law, p_min, p_max, near, far, 1.0}});
  };
  add(Behaviour::search, 0.1, 1.0, 0.0, 10.0);
  add(Behaviour::track, 0.04, 0.5, 0.1, 2.0);
  add(Behaviour::avoid, 0.04, 0.2, 0.1, 1.2);
  add(Behaviour::pick, 0.1, 0.3, 0.02, 0.8);
  add(Behaviour::place, 0.1, 0.3, 0.02, 0.5);
  add(Behaviour::give, 0.04, 0.3, 0.05, 1.0);
  add(Behaviour::receive, 0.04, 0.3, 0.05, 1.0);
  return s;
}

class AttentionTest : public testing::Test {
 protected:
  AttentionTest() : robot_(test::small_robot()), body_(*robot_, Vector3(0.4, 0, 0)) {
    active_.position = Vector::Zero(robot_->dof());
    active_.velocity = active_.acceleration = active_.position;
  }
  World world() const {
    return {&people_, facts_known_ ? &facts_ : nullptr, &action_, &active_, nullptr, &scene_};
  }
  void run(Attention& attention, double from, double to) {
    for (int k = static_cast<int>(from * 100); k < static_cast<int>(to * 100); ++k)
      attention.step(world(), at(0.01 * k));
  }
  const BehaviourState& of(const AttentionState& state, Behaviour b) const {
    for (const BehaviourState& s : state.behaviours)
      if (s.behaviour == b) return s;
    throw std::logic_error("no such behaviour");
  }
  void point_arm_at_person_with_trajectory(double speed) {
    active_.trajectory = 1;
    active_.axes = {2};
    AxisTrajectory axis;
    axis.start = {0.0, speed, 0.0};
    axis.segments = {{2.0, 0.0}};
    active_.rest.axes = {axis};
    active_.time = 0.0;
  }

  std::shared_ptr<const RobotModel> robot_;
  Body body_;
  HumanState people_;
  Facts facts_;
  bool facts_known_{};
  ActionStatus action_;
  ActiveTrajectory active_;
  Scene scene_;
};

TEST(AdaptiveClock, linear_law_meets_its_ends_and_the_shortest_period) {
  AdaptiveClock clock({ClockLaw::linear, 0.03, 0.3, 0.1, 1.1, 1.0}, Duration(0), "avoid");
  EXPECT_TRUE(clock.due(at(0)));
  clock.fire(1.1, at(0));
  EXPECT_NEAR(clock.period(), 0.3, 1e-12);
  clock.fire(0.6, at(1));
  EXPECT_NEAR(clock.period(), 0.3 * 0.55, 1e-12);
  clock.fire(0.1, at(2));
  EXPECT_NEAR(clock.period(), 0.03, 1e-12);
  clock.fire(1e30, at(3));
  EXPECT_NEAR(clock.period(), 0.3, 1e-12);
  EXPECT_FALSE(clock.due(at(3.29)));
  EXPECT_TRUE(clock.due(at(3.31)));
  EXPECT_EQ(clock.activations(), 4u);
  EXPECT_EQ(clock.activations_at_fastest(at(3)), 101u);
}

TEST(AdaptiveClock, weber_law_changes_the_period_in_proportion_to_the_relative_change) {
  AdaptiveClock clock({ClockLaw::weber, 0.01, 0.4, 0.1, 2.0, 1.0}, Duration(0), "avoid");
  clock.fire(1.0, at(0));
  EXPECT_NEAR(clock.period(), 0.2, 1e-12);
  clock.fire(0.5, at(1));
  EXPECT_NEAR(clock.period(), 0.1, 1e-12);
  clock.fire(0.5, at(2));
  EXPECT_NEAR(clock.period(), 0.1, 1e-12);
  clock.fire(0.6, at(3));
  EXPECT_NEAR(clock.period(), 0.12, 1e-12);
}

TEST(AdaptiveClock, the_fixed_law_heeds_nothing) {
  AdaptiveClock clock({ClockLaw::fixed, 0.01, 0.4, 0.1, 2.0, 1.0, 0.17}, Duration(0), "avoid");
  for (const double stimulus : {5.0, 0.0, 0.7}) {
    clock.fire(stimulus, at(1));
    EXPECT_EQ(clock.period(), 0.17);
  }
  EXPECT_THROW(
      AdaptiveClock({ClockLaw::fixed, 0.1, 0.4, 0.1, 2.0, 1.0, 0.05}, Duration(0), "avoid"),
      ConfigError);
}

TEST(AdaptiveClock, refuses_settings_that_cannot_work) {
  EXPECT_THROW(AdaptiveClock({ClockLaw::linear, 0.3, 0.1, 0.1, 1.0, 1.0}, Duration(0), "give"),
               ConfigError);
  EXPECT_THROW(AdaptiveClock({ClockLaw::linear, 0.0, 0.1, 0.1, 1.0, 1.0}, Duration(0), "give"),
               ConfigError);
  EXPECT_THROW(AdaptiveClock({ClockLaw::linear, 0.1, 0.2, 1.0, 1.0, 1.0}, Duration(0), "give"),
               ConfigError);
}

TEST(Zones, nearing_counts_at_once_and_leaving_needs_margin_and_time) {
  ZoneTracker zones({});
  EXPECT_EQ(zones.update(5.0, at(0)), Zone::far);
  EXPECT_EQ(zones.update(1.0, at(0.1)), Zone::interaction);
  EXPECT_EQ(zones.update(1.22, at(0.2)), Zone::interaction);
  EXPECT_EQ(zones.update(1.22, at(2.0)), Zone::interaction);
  EXPECT_EQ(zones.update(1.30, at(2.1)), Zone::interaction);
  EXPECT_EQ(zones.update(1.30, at(2.3)), Zone::interaction);
  EXPECT_EQ(zones.update(1.30, at(2.41)), Zone::social);
  EXPECT_EQ(zones.update(0.05, at(2.42)), Zone::contact);
}

TEST_F(AttentionTest, nobody_there_searches_and_does_not_slow) {
  Attention attention(settings(), body_);
  run(attention, 0, 3);
  const AttentionAdvice advice = attention.advice();
  EXPECT_EQ(advice.speed_factor, 1.0);
  EXPECT_TRUE(advice.has_gaze_target);
  EXPECT_TRUE(of(attention.state(), Behaviour::search).released);
}

TEST_F(AttentionTest, a_person_standing_still_at_arms_length_slows_nothing_and_is_looked_at) {
  Attention attention(settings(), body_);
  people_.people = {standing(2.1, 0)};
  run(attention, 0, 3);
  const AttentionAdvice advice = attention.advice();
  EXPECT_EQ(advice.speed_factor, 1.0);
  EXPECT_TRUE(advice.has_gaze_target);
  EXPECT_NEAR(advice.gaze_target.x(), people_.people[0].joints[0].position.x(), 1e-9);
  EXPECT_FALSE(of(attention.state(), Behaviour::search).released);
  EXPECT_TRUE(of(attention.state(), Behaviour::track).released);
  EXPECT_LE(of(attention.state(), Behaviour::search).activations, 4u)
      << "who is seen is not searched for";
}

TEST_F(AttentionTest, the_nearer_the_person_the_slower_the_arm_and_the_faster_the_clock) {
  double last_factor = 2.0, last_period = 1e9;
  for (double x : {2.0, 1.6, 1.3, 1.2, 1.1}) {
    Attention attention(settings(), body_);
    people_.people = {standing(x, 0)};
    run(attention, 0, 1);
    const AttentionState state = attention.state();
    EXPECT_LE(attention.advice().speed_factor, last_factor) << x;
    EXPECT_LE(of(state, Behaviour::avoid).period, last_period) << x;
    last_factor = attention.advice().speed_factor;
    last_period = of(state, Behaviour::avoid).period;
  }
  EXPECT_LT(last_factor, 0.5);
  EXPECT_NEAR(last_period, 0.04, 0.02);
}

TEST_F(AttentionTest, a_person_who_comes_fast_is_answered_sooner_than_one_who_stands) {
  Attention attention(settings(), body_);
  people_.people = {standing(1.5, 0)};
  run(attention, 0, 1);
  const double still = attention.advice().speed_factor,
               period = of(attention.state(), Behaviour::avoid).period;
  move(people_.people[0], Vector3::Zero(), Vector3(-1.5, 0, 0));
  run(attention, 1, 2);
  EXPECT_LT(attention.advice().speed_factor, still);
  EXPECT_LT(of(attention.state(), Behaviour::avoid).period, period);
}

TEST_F(AttentionTest,
       who_takes_part_in_an_exchange_may_be_nearer_than_others_before_the_arm_slows) {
  people_.people = {standing(1.5, 0)};
  const double distance =
      body_.separation_at(active_.position, active_.T_world_base, people_, {}).distance;
  ASSERT_GT(distance, 0.40);
  ASSERT_LT(distance, 0.60);
  Attention passing(settings(), body_);
  run(passing, 0, 0.5);
  EXPECT_LT(passing.advice().speed_factor, 1.0);
  action_.kind = ActionKind::receive;
  action_.state = ActionState::running;
  action_.human = "anna";
  Attention exchanging(settings(), body_);
  run(exchanging, 0, 0.5);
  EXPECT_EQ(of(exchanging.state(), Behaviour::avoid).speed_factor, 1.0);
  action_.human = "ben";
  Attention beside(settings(), body_);
  run(beside, 0, 0.5);
  EXPECT_LT(of(beside.state(), Behaviour::avoid).speed_factor, 1.0);
}

TEST_F(AttentionTest, recoils_only_when_running_back_leads_away) {
  Attention attention(settings(), body_);
  people_.people = {standing(0.6, 0.36)};
  move(people_.people[0], Vector3::Zero(), Vector3(-0.5, -0.5, 0));
  ASSERT_LT(body_.separation_at(active_.position, active_.T_world_base, people_, {}).distance,
            0.06);
  point_arm_at_person_with_trajectory(0.0);
  run(attention, 0, 0.5);
  EXPECT_GE(attention.advice().speed_factor, 0.0);
  EXPECT_LT(attention.advice().speed_factor, 0.1);
  EXPECT_TRUE(attention.advice().leaves_path) << "neither way along the path leads away";

  active_.axes = {0};
  active_.rest.axes[0].start = {-0.3, 0.5, 0.0};
  active_.time = 0.6;
  run(attention, 0.5, 1.0);
  EXPECT_LT(attention.advice().speed_factor, 0.0);
  EXPECT_FALSE(attention.advice().leaves_path);
  EXPECT_EQ(attention.advice().limiting, "avoid");
}

TEST_F(AttentionTest, the_faster_a_person_comes_the_farther_away_the_arm_recoils) {
  people_.people = {standing(0.8, 0.5)};
  const double distance =
      body_.separation_at(active_.position, active_.T_world_base, people_, {}).distance;
  ASSERT_GT(distance, 0.15);
  ASSERT_LT(distance, 0.5);
  const double needed = distance / settings().motor.recoil_time;
  for (const double speed : {0.5 * needed, 1.5 * needed}) {
    move(people_.people[0], Vector3::Zero(), speed * Vector3(-0.8, -0.5, 0).normalized());
    Attention attention(settings(), body_);
    run(attention, 0, 0.5);
    EXPECT_EQ((attention.advice().speed_factor < 0.0), (speed > needed)) << speed << " m/s";
  }
}

TEST_F(AttentionTest, an_arm_that_leads_away_keeps_moving) {
  Attention attention(settings(), body_);
  people_.people = {standing(0.8, 0.3)};
  active_.trajectory = 1;
  active_.axes = {0};
  AxisTrajectory axis;
  axis.start = {0.0, -0.5, 0.0};
  axis.segments = {{2.0, 0.0}};
  active_.rest.axes = {axis};
  run(attention, 0, 0.5);
  EXPECT_GE(attention.advice().speed_factor, 0.5);
}

TEST_F(AttentionTest, an_arm_that_leads_away_softly_is_not_held_where_it_begins_nor_where_it_ends) {
  people_.people = {standing(0.8, 0.3)};
  active_.trajectory = 1;
  active_.axes = {0};
  const double turn = -0.05 * 2.0;
  AxisTrajectory axis;
  for (const double jerk : {-1.0, 1.0, 1.0, -1.0}) axis.segments.push_back({0.45, jerk});
  axis.start = {0.0, 0.0, 0.0};
  active_.rest.axes = {axis};
  EXPECT_LT(active_.rest.at(1.8).position[0], turn);
  for (const double time : {0.0, 0.9, 1.75}) {
    Attention attention(settings(), body_);
    active_.time = time;
    active_.position[0] = active_.rest.at(time).position[0];
    run(attention, 0, 0.5);
    EXPECT_GE(attention.advice().speed_factor, 0.5) << time;
  }
}

TEST_F(AttentionTest, the_exchanging_hand_does_not_stop_the_robot_once_engaged) {
  people_.people = {standing(1.45, 0)};
  for (std::size_t j : {std::size_t{9}, std::size_t{10}, std::size_t{11}})
    people_.people[0].joints[j].position = Vector3(0.95 - 0.0 * static_cast<double>(j), 0, 1.0);
  people_.people[0].joints[9].position.x() = 1.2;
  action_.kind = ActionKind::give;
  action_.state = ActionState::running;
  action_.holding = true;
  action_.human = "anna";
  Attention before(settings(), body_);
  run(before, 0, 1);
  action_.exchange_engaged = true;
  Attention engaged(settings(), body_);
  run(engaged, 0, 1);
  EXPECT_LT(of(before.state(), Behaviour::avoid).speed_factor, 0.35);
  EXPECT_GT(of(engaged.state(), Behaviour::avoid).speed_factor,
            of(before.state(), Behaviour::avoid).speed_factor);
  EXPECT_TRUE(of(engaged.state(), Behaviour::give).released);
  EXPECT_GT(engaged.advice().speed_factor, 0.0);
  EXPECT_FALSE(engaged.advice().has_target_shift);
}

/// A receiver whose right hand is extended at one place, with an offer planned at another.
class ShiftTest : public AttentionTest {
 protected:
  ShiftTest() {
    people_.people = {standing(1.6, 0)};
    action_.kind = ActionKind::give;
    action_.state = ActionState::running;
    action_.phase = ActionPhase::carry;
    action_.holding = true;
    action_.human = "anna";
    action_.exchange_point = Vector3(1.0, 0.0, 1.1);
    action_.has_partner = true;
    action_.partner_side = Side::right;
    action_.T_world_partner_wrist = make_pose({1.12, 0.0, 1.1});
    hold_out(Side::right, planned_ + beside_);
  }
  void hold_out(Side side, const Vector3& p_wrist) {
    auto& joints = people_.people[0].joints;
    joints[side == Side::left ? body::l_wrist : body::r_wrist].position = p_wrist;
    joints[side == Side::left ? body::l_hand : body::r_hand].position =
        p_wrist - Vector3(0.07, 0, 0);
  }
  AttentionAdvice after(double seconds, double limit = 0.15) {
    AttentionSettings given = settings();
    given.motor.shift_limit = limit;
    Attention attention(given, body_);
    run(attention, 0, seconds);
    return attention.advice();
  }
  const Vector3 planned_{1.12, 0.0, 1.1}, beside_{0.05, 0.1, 0.02};
};

TEST_F(ShiftTest, give_asks_for_the_hand_that_is_held_out) {
  const AttentionAdvice advice = after(1.5);
  ASSERT_TRUE(advice.has_target_shift);
  EXPECT_LT((advice.target_shift - beside_).norm(), 1e-9);
  EXPECT_FALSE(after(0.2).has_target_shift) << "it has just come";
  const Vector3 bounded = after(1.5, 0.06).target_shift;
  EXPECT_NEAR(bounded.norm(), 0.06, 1e-9);
  EXPECT_LT(bounded.cross(beside_).norm(), 1e-9);
}

TEST_F(ShiftTest, give_asks_for_nothing_while_no_hand_is_held_out) {
  people_.people = {standing(1.6, 0)};
  EXPECT_FALSE(after(1.5).has_target_shift) << "both hands hang";
  hold_out(Side::left, planned_ + beside_);
  EXPECT_FALSE(after(1.5).has_target_shift) << "the handover is planned for the other hand";
  action_.has_partner = false;
  EXPECT_TRUE(after(1.5).has_target_shift) << "it is planned for none";
  people_.people[0].joints[body::l_hand].velocity = Vector3(0, 0.4, 0);
  EXPECT_FALSE(after(1.5).has_target_shift) << "the hand only passes";
}

TEST_F(ShiftTest, give_asks_for_nothing_before_the_object_is_carried_nor_once_a_hand_is_there) {
  action_.phase = ActionPhase::choosing_exchange_point;
  EXPECT_FALSE(after(1.5).has_target_shift);
  action_.phase = ActionPhase::offer;
  EXPECT_TRUE(after(1.5).has_target_shift);
  const Vector3 p_robot_hand = body_.grasp_point(active_.position, active_.T_world_base);
  hold_out(Side::right, p_robot_hand + Vector3(0.2, 0, 0));
  EXPECT_FALSE(after(1.5).has_target_shift);
}

TEST_F(ShiftTest, receive_asks_for_where_the_giver_moves_the_object) {
  action_.kind = ActionKind::receive;
  action_.phase = ActionPhase::approach;
  action_.holding = false;
  action_.object = "mug";
  scene_.objects = {{"mug", "mug", make_pose({1.02, 0.03, 1.1}), Holder::human, "anna", 0}};
  const Vector3 moved = Vector3(1.02, 0.03, 1.1) - action_.exchange_point;
  AttentionAdvice advice = after(1.5);
  ASSERT_TRUE(advice.has_target_shift);
  EXPECT_LT((advice.target_shift - moved).norm(), 1e-9);
  const Vector3 velocity(0, 0.3, 0);
  scene_.objects[0].velocity = velocity;
  advice = after(1.5);
  EXPECT_LT((advice.target_shift - moved - settings().motor.shift_lead * velocity).norm(), 1e-9);
  scene_.objects[0].holder = Holder::surface;
  EXPECT_FALSE(after(1.5).has_target_shift) << "it is no longer in the hand";
}

TEST_F(AttentionTest, the_person_whom_an_object_is_picked_for_expects_the_robot_near) {
  people_.people = {standing(1.2, 0)};
  action_.kind = ActionKind::pick;
  action_.state = ActionState::running;
  Attention for_nobody(settings(), body_);
  run(for_nobody, 0, 1);
  action_.human = "anna";
  Attention for_anna(settings(), body_);
  run(for_anna, 0, 1);
  action_.human = "bob";
  Attention for_another(settings(), body_);
  run(for_another, 0, 1);
  const auto factor = [this](const Attention& a) {
    return of(a.state(), Behaviour::avoid).speed_factor;
  };
  EXPECT_LT(factor(for_nobody), 1.0);
  EXPECT_GT(factor(for_anna), factor(for_nobody) + 0.1);
  EXPECT_EQ(factor(for_another), factor(for_nobody));
}

TEST_F(AttentionTest, give_waits_for_an_attentive_person) {
  people_.people = {standing(1.8, 0)};
  action_.kind = ActionKind::give;
  action_.state = ActionState::running;
  action_.holding = true;
  facts_known_ = true;
  Attention attention(settings(), body_);
  run(attention, 0, 1);
  EXPECT_FALSE(of(attention.state(), Behaviour::give).released);
  facts_.facts = {{FactKind::attentive, "anna", "", 1.0, 0.5}};
  run(attention, 1, 2);
  EXPECT_TRUE(of(attention.state(), Behaviour::give).released);
}

TEST_F(AttentionTest, picking_eases_over_the_last_ten_centimetres) {
  action_.kind = ActionKind::pick;
  action_.state = ActionState::running;
  action_.object = "mug";
  SceneObject mug;
  mug.id = "mug";
  mug.T_world_object.translation() = Vector3(1.4, 0, 1.0);
  scene_.objects = {mug};
  Attention far(settings(), body_);
  run(far, 0, 0.5);
  EXPECT_EQ(far.advice().speed_factor, 1.0);
  scene_.objects[0].T_world_object.translation() = Vector3(0.85, 0, 1.0);
  Attention near(settings(), body_);
  run(near, 0, 0.5);
  EXPECT_NEAR(near.advice().speed_factor, 0.4 + 0.6 * 0.5, 1e-6);
  EXPECT_EQ(near.advice().limiting, "pick");
  action_.holding = true;
  run(near, 0.5, 0.6);
  EXPECT_EQ(near.advice().speed_factor, 1.0);
}

TEST_F(AttentionTest, clocks_save_work_when_nothing_is_near_and_not_when_it_matters) {
  Attention calm(settings(), body_);
  people_.people = {standing(4.0, 0)};
  run(calm, 0, 10);
  const BehaviourState relaxed = of(calm.state(), Behaviour::avoid);
  EXPECT_LT(static_cast<double>(relaxed.activations),
            0.3 * static_cast<double>(relaxed.activations_at_fastest));
  EXPECT_GT(relaxed.activations, 40u);
  Attention close(settings(), body_);
  people_.people = {standing(1.05, 0)};
  run(close, 0, 10);
  const BehaviourState alert = of(close.state(), Behaviour::avoid);
  EXPECT_GT(static_cast<double>(alert.activations),
            0.8 * static_cast<double>(alert.activations_at_fastest));
}

TEST_F(AttentionTest, both_laws_run_every_behaviour) {
  for (ClockLaw law : {ClockLaw::linear, ClockLaw::weber}) {
    Attention attention(settings(law), body_);
    people_.people = {standing(3.0, 0)};
    for (int k = 0; k < 300; ++k) {
      move(people_.people[0], Vector3(-0.006, 0, 0), Vector3(-0.6, 0, 0));
      attention.step(world(), at(0.01 * k));
    }
    for (const BehaviourState& b : attention.state().behaviours) {
      EXPECT_GT(b.activations, 0u) << name(b.behaviour);
      EXPECT_LE(b.activations, b.activations_at_fastest) << name(b.behaviour);
    }
    EXPECT_LT(of(attention.state(), Behaviour::avoid).period, 0.15);
  }
}

TEST_F(AttentionTest, settings_that_contradict_themselves_are_refused_by_name) {
  AttentionSettings twice = settings();
  twice.behaviours.push_back(twice.behaviours.front());
  try {
    Attention attention(twice, body_);
    FAIL() << "accepted";
  } catch (const ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("search"));
  }
  EXPECT_THROW(Attention({}, body_), ConfigError);
}

TEST_F(AttentionTest, missing_samples_hurt_nothing) {
  Attention attention(settings(), body_);
  for (int k = 0; k < 200; ++k) attention.step({}, at(0.01 * k));
  EXPECT_EQ(attention.advice().speed_factor, 1.0);
  EXPECT_FALSE(attention.advice().has_gaze_target);
}

TEST_F(AttentionTest,
       who_reaches_for_what_is_put_down_is_to_be_given_it_and_who_only_stands_there_is_not) {
  Attention attention(settings(), body_);
  action_.kind = ActionKind::place;
  action_.state = ActionState::running;
  action_.object = "mug";
  action_.holding = true;
  Person anna = standing(2, 0);
  anna.joints[11].position =
      body_.grasp_point(active_.position, active_.T_world_base) + Vector3(0.4, 0, 0);
  people_.people = {anna};
  facts_known_ = true;
  run(attention, 0, 2);
  EXPECT_EQ(attention.advice().change, TaskChange::none);
  facts_.facts = {{FactKind::reaching, "anna", "mug", 0.4, 0.1}};
  run(attention, 2, 3);
  EXPECT_EQ(attention.advice().change, TaskChange::give);
  EXPECT_EQ(attention.advice().person, "anna");
  facts_.facts.clear();
  run(attention, 3, 4);
  EXPECT_EQ(attention.advice().change, TaskChange::none);
  facts_.facts = {{FactKind::reaching, "anna", "mug", 0.4, 0.1}};
  action_.kind = ActionKind::give;
  run(attention, 4, 5);
  EXPECT_EQ(attention.advice().change, TaskChange::none) << "it is being given already";
}

TEST_F(AttentionTest, off_it_looks_at_nothing_and_asks_for_nothing) {
  AttentionSettings off = settings();
  off.off = true;
  Attention attention(off, body_);
  people_.people = {standing(0.6, 0.3)};
  point_arm_at_person_with_trajectory(0.5);
  run(attention, 0, 2);
  EXPECT_EQ(attention.advice().speed_factor, 1.0);
  EXPECT_FALSE(attention.advice().has_gaze_target);
  for (const BehaviourState& state : attention.state().behaviours) EXPECT_EQ(state.activations, 0u);
}

TEST_F(AttentionTest, work_is_as_urgent_as_the_most_urgent_behaviour_it_serves) {
  AttentionSettings s = settings();
  s.works = {{Work::forecast, 0.02, 0.06, 0, {"avoid"}},
             {Work::cost_map, 0.08, 0.4, 0, {"pick", "avoid"}},
             {Work::replan, 0.2, 0.8, 0.5, {"give"}}};
  Attention attention(s, body_);
  run(attention, 0, 2);
  EXPECT_NEAR(attention.advice().forecast_period, 0.06, 1e-9);
  EXPECT_NEAR(attention.advice().cost_map_period, 0.4, 1e-9);
  EXPECT_EQ(attention.advice().people_period, 0.0) << "not described: as it comes";
  people_.people = {standing(0.6, 0.1)};
  run(attention, 2, 4);
  const double ease = (of(attention.state(), Behaviour::avoid).period - 0.04) / 0.16;
  EXPECT_LT(ease, 0.5);
  EXPECT_NEAR(attention.advice().forecast_period, 0.02 + 0.04 * ease, 1e-9);
  EXPECT_NEAR(attention.advice().cost_map_period, 0.08 + 0.32 * ease, 1e-9);
  EXPECT_EQ(attention.advice().replan_period, 0.5) << "fixed";
}

TEST_F(AttentionTest,
       a_behaviour_that_is_only_described_watches_slows_and_waits_for_what_it_names) {
  AttentionSettings s = settings();
  BehaviourSettings mind{
      Behaviour::watch, {ClockLaw::linear, 0.04, 0.3, 0.1, 1.0, 1.0}, "mind_the_hand"};
  mind.watch = {Input::hand_distance, 0.6, 0.1, 0.2, GazeAt::hand, "a hand is near"};
  mind.conditions = {parse_condition("behaviour track"), parse_condition("not holding")};
  std::erase_if(s.behaviours,
                [](const BehaviourSettings& b) { return b.behaviour == Behaviour::avoid; });
  s.behaviours.insert(s.behaviours.begin(), mind);
  Attention attention(s, body_);
  Person anna = standing(3, 0);
  anna.joints[11].position =
      body_.grasp_point(active_.position, active_.T_world_base) + Vector3(0.35, 0, 0);
  people_.people = {anna};
  run(attention, 0, 1);
  EXPECT_EQ(attention.advice().limiting, "mind_the_hand");
  EXPECT_NEAR(attention.advice().speed_factor, 0.6, 1e-6);
  EXPECT_EQ(attention.advice().reason, "a hand is near");
  EXPECT_EQ(attention.state().behaviours.front().name, "mind_the_hand");
  EXPECT_TRUE(attention.state().behaviours.front().winner);
  action_.holding = true;
  run(attention, 1, 2);
  EXPECT_EQ(attention.advice().speed_factor, 1.0);
  EXPECT_EQ(attention.advice().limiting, "");
}

std::string refusal_of(std::string settings, const std::string& part, const std::string& instead) {
  settings.replace(settings.find(part), part.size(), instead);
  const test::TemporaryFolder folder;
  const std::string file = folder.write("attention.txtpb", settings);
  return test::message_of<ConfigError>([&] { load_settings(file); });
}

TEST(AttentionSettingsFile, a_behaviour_that_cannot_be_is_refused_where_it_stands) {
  std::ifstream in(resource("config/attention.txtpb"));
  const std::string shipped((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(refusal_of(shipped, "tick", "tick"), "no error");
  const std::string order = refusal_of(shipped, "p_min: 0.04 p_max: 0.8", "p_min: 1.0 p_max: 0.8");
  EXPECT_THAT(order, HasSubstr("attention.txtpb:40"));
  EXPECT_THAT(order, HasSubstr("behaviour avoid: p_max must not be below p_min"));
  const std::string stranger = refusal_of(shipped, "\"give\"", "\"hug\"");
  EXPECT_THAT(stranger, HasSubstr("attention.txtpb:43"));
  EXPECT_THAT(stranger,
              HasSubstr("\"hug\" is none of search, track, avoid, pick, place, give, receive"));
  EXPECT_THAT(refusal_of(shipped, "\"pick\"    law: LINEAR", "\"pick\" law: MARGIN"),
              HasSubstr("attention.txtpb:41:law: MARGIN needs the distance to people"));
  EXPECT_EQ(refusal_of(shipped, "\"avoid\"   law: LINEAR", "\"avoid\" law: MARGIN"), "no error");
  EXPECT_THAT(refusal_of(shipped, "law: LINEAR", "law: FIXED"),
              HasSubstr("behaviour search: period must be from p_min to p_max"));
}

TEST(AttentionSettingsFile, what_a_user_adds_is_refused_where_it_is_wrong) {
  std::ifstream in(resource("config/attention.txtpb"));
  const std::string shipped((std::istreambuf_iterator<char>(in)), {});
  const auto added = [&](const std::string& text) {
    const test::TemporaryFolder folder;
    const std::string file = folder.write("attention.txtpb", shipped + text);
    return test::message_of<ConfigError>([&] { load_settings(file); });
  };
  const std::string line = std::to_string(std::count(shipped.begin(), shipped.end(), '\n') + 2);
  const std::string begin = "behaviours {\n";
  const std::string clock = "p_min: 0.04 p_max: 0.3 near: 0.1 far: 1 weber_gain: 1 kind: WATCH ";
  EXPECT_EQ(added(begin + "name: \"mind\" input: \"hand_distance\" " + clock + "}"), "no error");
  const std::string input = added(begin + "name: \"mind\" input: \"mood\" " + clock + "}");
  EXPECT_THAT(input, HasSubstr("attention.txtpb:" + line + ":input"));
  EXPECT_THAT(input, HasSubstr("\"mood\" is none of human_distance, hand_distance"));
  EXPECT_THAT(
      added(begin + "name: \"mind\" input: \"hand_distance\" released_when: \"fact bored\" " +
            clock + "}"),
      HasSubstr("attention.txtpb:" + line + ":released_when: \"bored\" is no fact"));
  EXPECT_THAT(
      added(begin + "name: \"mind\" input: \"hand_distance\" released_when: \"behaviour other\" " +
            clock + "}\n" + begin +
            "name: \"other\" input: \"hand_distance\" released_when: \"not behaviour mind\" " +
            clock + "}"),
      testing::AllOf(HasSubstr("attention.txtpb:" + line + ":released_when"),
                     HasSubstr("mind -> other -> mind")));
  EXPECT_THAT(
      added(begin + "name: \"mind\" released_when: \"behaviour nobody\" input: \"clearance\" " +
            clock + "}"),
      HasSubstr("\"nobody\", which is not described"));
  std::string many;
  for (int i = 0; i < 17; ++i)
    many +=
        begin + "name: \"mind" + std::to_string(i) + "\" input: \"hand_distance\" " + clock + "}\n";
  EXPECT_THAT(added(many), HasSubstr("at most 16 are allowed"));
  EXPECT_THAT(
      added("works {\nname: \"weather\" p_min: 1 p_max: 2 serves: \"avoid\" }"),
      HasSubstr("attention.txtpb:" + line +
                ":name: \"weather\" is none of people, objects, forecast, cost_map, replan, "
                "sensed_people, sensed_objects, sensed_region"));
  EXPECT_THAT(added("works {\nname: \"people\" p_min: 3 p_max: 2 serves: \"avoid\" }"),
              HasSubstr("attention.txtpb:" + line + ":p_max: p_max must not be below p_min"));
}

TEST(AttentionSettingsFile, the_example_is_a_behaviour_that_can_be) {
  const auto text = [](const std::filesystem::path& file) {
    std::ifstream in(file);
    return std::string((std::istreambuf_iterator<char>(in)), {});
  };
  const test::TemporaryFolder folder;
  const AttentionSettings settings = load_settings(folder.write(
      "attention.txtpb", text(resource("config/attention.txtpb")) +
                             text(HANDSEL_SOURCE_DIR "/examples/attention/mind_the_hand.txtpb")));
  ASSERT_EQ(settings.behaviours.back().name, "mind_the_hand");
  EXPECT_EQ(settings.behaviours.back().conditions.size(), 3u);
  const auto robot = test::small_robot();
  const Body body(*robot, Vector3(0.4, 0, 0));
  EXPECT_EQ(Attention(settings, body).state().behaviours.size(), 8u);
}

TEST(AdvisedPeriod, keeps_to_what_is_advised_within_its_limits_and_forgets_old_advice) {
  AdvisedPeriod pace(0.02, 0.06, 0.02);
  EXPECT_TRUE(pace.due(at(0)));
  pace.done(at(0));
  EXPECT_FALSE(pace.due(at(0.005)));
  EXPECT_TRUE(pace.due(at(0.02)));
  pace.advise(1.0, at(0));
  EXPECT_EQ(pace.period(at(0.1)), 0.06);
  EXPECT_FALSE(pace.due(at(0.04)));
  EXPECT_TRUE(pace.due(at(0.06)));
  pace.advise(0.0, at(0.1));
  EXPECT_EQ(pace.period(at(0.1)), 0.02);
  pace.advise(0.05, at(0.2));
  EXPECT_EQ(pace.period(at(0.4)), 0.05);
  EXPECT_EQ(pace.period(at(0.6)), 0.02) << "attention is silent";
}

}  // namespace
}  // namespace handsel::attention::attention_test
