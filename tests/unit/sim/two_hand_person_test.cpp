// SPDX-License-Identifier: Apache-2.0
// A person who takes what is wide or heavy with both hands.
#include <gtest/gtest.h>

#include "common/model/object_surface.hpp"
#include "sim/people/two_hand_hold.hpp"
#include "tests/unit/sim/person_fixture.hpp"

namespace handsel::sim::two_hand_person_test {
namespace {

using namespace test;

const ObjectModel& tray() {
  static const ObjectModel model = ObjectModel::load(deploy() / "objects/tray/tray.txtpb");
  return model;
}

/// A tray across before a person at (1.25, 0), a hand of the robot at the knob at either end.
class TrayTest : public testing::Test {
 protected:
  TrayTest() {
    view_.object = &tray();
    view_.T_world_object = make_pose(
        {0.65, 0, 1.05}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitZ())));
    view_.held_by_robot = true;
    for (const double side : {-1.0, 1.0}) {
      const Vector3 knob = view_.T_world_object * Vector3(side * 0.235, 0, 0.0325);
      robot_.push_back({knob, knob + Vector3(-0.25, 0, 0.1), 0.06});
    }
    view_.robot = &robot_;
    view_.robot_hand = robot_[0].b;
    PersonSettings settings = taker();
    settings.feet = Vector3(1.25, 0, 0);
    person_.emplace(settings);
  }
  double gap(int side) const {
    return surface_distance(
        tray(), view_.T_world_object.inverse() * person_->hand(side).T_world_body.translation());
  }

  PersonView view_;
  std::vector<HandPart> robot_;
  std::optional<PersonModel> person_;
};

TEST_F(TrayTest, both_hands_come_to_their_own_sides_at_the_same_time) {
  step_until(*person_, view_, PersonPhase::pulling, 8);
  ASSERT_EQ(person_->phase(), PersonPhase::pulling);
  EXPECT_TRUE(person_->uses_both_hands());
  for (const int side : {0, 1}) {
    EXPECT_NEAR(gap(side), kPalmDistance, 0.013) << side;
    EXPECT_TRUE(person_->hand_configuration(side)) << side;
    EXPECT_TRUE(person_->takes_part(side == 0 ? Side::left : Side::right));
  }
  // The person faces -x: the left side is -y.
  EXPECT_LT(person_->hand(0).T_world_body.translation().y(), -0.07);
  EXPECT_GT(person_->hand(1).T_world_body.translation().y(), 0.07);
}

TEST_F(TrayTest, both_hands_draw_the_tray_by_the_same_distance) {
  step_until(*person_, view_, PersonPhase::pulling, 8);
  ASSERT_EQ(person_->phase(), PersonPhase::pulling);
  const Vector3 left = person_->hand(0).T_world_body.translation(),
                right = person_->hand(1).T_world_body.translation();
  view_.held_by_robot = false;
  step_for(*person_, view_, 1.0);
  const Vector3 left_moved = person_->hand(0).T_world_body.translation() - left,
                right_moved = person_->hand(1).T_world_body.translation() - right;
  EXPECT_GT(right_moved.norm(), 0.02);
  EXPECT_LT((left_moved - right_moved).norm(), 0.02);
}

TEST_F(TrayTest, waits_where_the_robot_leaves_a_place_for_one_hand_only) {
  for (double x = 0; x <= 0.3; x += 0.05) {
    const Vector3 p = view_.T_world_object * Vector3(x, 0, -0.05);
    robot_.push_back({p + Vector3(-0.15, 0, 0), p + Vector3(0.15, 0, 0), 0.1});
  }
  step_for(*person_, view_, 6);
  EXPECT_EQ(person_->phase(), PersonPhase::watching);
  EXPECT_FALSE(person_->uses_both_hands());
}

TEST_F(TrayTest, one_hand_takes_what_is_neither_wide_nor_heavy) {
  PersonModel person(taker());
  const PersonView mug = offer({0.95, 0.05, 1.05});
  step_until(person, mug, PersonPhase::pulling, 8);
  ASSERT_EQ(person.phase(), PersonPhase::pulling);
  EXPECT_FALSE(person.uses_both_hands());
  EXPECT_FALSE(person.hand_configuration(0));
}

/// A giver of a tray at (1.25, 0); nothing of the robot is near.
class TrayGiverTest : public testing::Test {
 protected:
  TrayGiverTest() {
    PersonSettings settings = taker();
    settings.feet = Vector3(1.25, 0, 0);
    settings.kind = PersonKind::giver;
    person_.emplace(settings);
    T_hand_object_ = person_->hold_from_beginning(tray(), Eigen::Quaterniond::Identity());
    view_.object = &tray();
    view_.robot = &robot_;
    view_.robot_hand = Vector3(0.2, 0, 1.2);
    view_.finger_distance = 1;
  }
  /// Lets the person live for a while [s]; the tray moves with the leading hand.
  void live(double time) {
    for (int i = 0; i < 1000 * time; ++i) {
      view_.T_world_object = person_->hand().T_world_body * *T_hand_object_;
      person_->step(0.001, view_);
    }
  }
  double gap(int side) const {
    return surface_distance(
        tray(), view_.T_world_object.inverse() * person_->hand(side).T_world_body.translation());
  }

  PersonView view_;
  std::vector<HandPart> robot_;
  std::optional<PersonModel> person_;
  std::optional<Pose> T_hand_object_;
};

TEST_F(TrayGiverTest, holds_what_is_wide_across_with_both_hands_and_offers_it_level) {
  ASSERT_TRUE(T_hand_object_);
  EXPECT_TRUE(person_->uses_both_hands());
  live(4);
  ASSERT_EQ(person_->phase(), PersonPhase::offering);
  EXPECT_TRUE(person_->is_offering());
  for (const int side : {0, 1}) {
    EXPECT_NEAR(gap(side), kPalmDistance, 0.013) << side;
    EXPECT_TRUE(person_->hand_configuration(side)) << side;
  }
  const Vector3 long_axis = view_.T_world_object.linear().col(0);
  EXPECT_NEAR(std::abs(long_axis.y()), 1, 0.01) << "across before a person who faces -x";
  const Vector3 p = view_.T_world_object.translation();
  EXPECT_NEAR(p.y(), 0, 0.05) << "before the middle of the trunk";
  EXPECT_LT(p.x(), 1.25 - 0.35);
}

TEST_F(TrayGiverTest, releases_with_both_hands_what_the_robot_bears) {
  live(4);
  ASSERT_EQ(person_->phase(), PersonPhase::offering);
  view_.held_by_robot = true;
  live(2);
  EXPECT_TRUE(person_->wants_grip()) << "fingers that touch it do not bear it yet";
  view_.held_firmly = true;
  live(1);
  EXPECT_FALSE(person_->wants_grip());
  live(4);
  EXPECT_FALSE(person_->uses_both_hands()) << "both hands are back at rest";
}

TEST(TwoHandHold, bears_a_load_beside_the_hands_and_breaks_at_twice_the_force_of_one) {
  constexpr double kMass = 3.0, kInertia = 0.02, kStep = 0.001;
  GripSettings settings;
  settings.max_force = 40;
  TwoHandHold hold(settings);
  std::array<BodyState, 2> hands;
  hands[0].T_world_body = make_pose({0.1, 0.15, 0});
  hands[1].T_world_body = make_pose({0.1, -0.15, 0});
  BodyState load;
  hold.hold({hands[0].T_world_body, hands[1].T_world_body}, load.T_world_body);
  const auto fall = [&](double weight, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kStep) && hold.holding(); ++i) {
      hold.update(hands, load, kMass, kInertia, kStep);
      const Wrench& w = hold.on_object();
      load.velocity += kStep * (w.force / kMass - Vector3(0, 0, weight / kMass));
      load.angular_velocity += kStep * w.torque / kInertia;
      load.T_world_body.translation() += kStep * load.velocity;
      const double angle = kStep * load.angular_velocity.norm();
      if (angle > 0)
        load.T_world_body.linear() =
            Eigen::AngleAxisd(angle, load.angular_velocity.normalized()).toRotationMatrix() *
            load.T_world_body.linear();
    }
  };
  fall(30, 2);
  ASSERT_TRUE(hold.holding());
  EXPECT_LT(load.T_world_body.translation().norm(), 0.02);
  EXPECT_NEAR(hold.on_object().force.z(), 30, 0.5);
  for (const int side : {0, 1}) EXPECT_NEAR(hold.on_hand(side).force.z(), -15, 1.0);
  fall(90, 1);
  EXPECT_FALSE(hold.holding());
  EXPECT_EQ(hold.on_object().force.norm(), 0);
}

}  // namespace
}  // namespace handsel::sim::two_hand_person_test
