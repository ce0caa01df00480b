// SPDX-License-Identifier: Apache-2.0
// A hand that somebody drags from outside.
#include <gtest/gtest.h>

#include "tests/unit/sim/person_fixture.hpp"

namespace handsel::sim::person_guided_test {
namespace {

using namespace test;

/// Lives for `time` [s] and checks that the hand moves within its bounds.
class Motion {
 public:
  explicit Motion(PersonModel& person, int side) : person_(person), side_(side), at_(hand()) {}

  Vector3 hand() const {
    return person_.body().joints[joint(side_ == 0 ? "l_hand" : "r_hand")].position;
  }
  void live(const PersonView& view, double time) {
    for (int i = 0; i < 1000 * time; ++i) {
      person_.step(0.001, view);
      const Vector3 v = (hand() - at_) / 0.001;
      max_speed_ = std::max(max_speed_, v.norm());
      max_acceleration_ = std::max(max_acceleration_, (v - v_).norm() / 0.001);
      v_ = v;
      at_ = hand();
    }
  }
  double max_speed() const { return max_speed_; }
  double max_acceleration() const { return max_acceleration_; }

 private:
  PersonModel& person_;
  int side_;
  Vector3 at_, v_{Vector3::Zero()};
  double max_speed_{0}, max_acceleration_{0};
};

TEST(GuidedPerson, hand_goes_where_it_is_dragged_and_back_when_nobody_drags_it) {
  for (const Side side : {Side::left, Side::right}) {
    PersonModel person(taker());
    Motion motion(person, side == Side::left ? 0 : 1);
    const PersonView nothing;
    motion.live(nothing, 0.1);
    const Vector3 rest = motion.hand(), wanted(1.05, 0.05, 1.15);
    for (int i = 0; i < 20; ++i) {
      person.guide_hand(side, wanted, 0.5);
      motion.live(nothing, 0.1);
    }
    EXPECT_LT((motion.hand() - wanted).norm(), 0.01);
    EXPECT_EQ(person.phase(), PersonPhase::guided);
    EXPECT_FALSE(person.in_handover()) << "its distance counts";
    motion.live(nothing, 0.3);
    EXPECT_LT((motion.hand() - wanted).norm(), 0.01) << "half a second after the last message";
    motion.live(nothing, 2.5);
    EXPECT_LT((motion.hand() - rest).norm(), 0.002);
    EXPECT_EQ(person.phase(), PersonPhase::watching);
    EXPECT_LE(motion.max_speed(), 1.02 * PersonManners{}.guided_max_speed);
    EXPECT_LE(motion.max_acceleration(), 2 * PersonManners{}.guided_max_acceleration);
    EXPECT_GT(motion.max_speed(), 0.5);
  }
}

TEST(GuidedPerson, hand_stays_within_reach_of_the_shoulder) {
  PersonModel person(taker());
  Motion motion(person, 1);
  person.guide_hand(Side::right, {-50, 20, 3}, 5);
  motion.live({}, 4);
  const Vector3 shoulder = person.body().joints[joint("r_shoulder")].position;
  EXPECT_NEAR((motion.hand() - shoulder).norm(), 0.95 * person.reach(), 0.02);
}

TEST(GuidedPerson, reach_and_speed_are_settings) {
  PersonSettings settings = taker();
  settings.manners.guided_max_reach = 0.6;
  settings.manners.guided_max_speed = 0.2;
  PersonModel person(settings);
  Motion motion(person, 1);
  person.guide_hand(Side::right, {-50, 20, 3}, 10);
  motion.live({}, 8);
  const Vector3 shoulder = person.body().joints[joint("r_shoulder")].position;
  EXPECT_NEAR((motion.hand() - shoulder).norm(), 0.6 * person.reach(), 0.02);
  EXPECT_LE(motion.max_speed(), 1.02 * 0.2);
}

TEST(GuidedPerson, goes_back_at_once_when_the_drag_ends) {
  PersonModel person(taker());
  Motion motion(person, 1);
  const Vector3 rest = motion.hand();
  person.guide_hand(Side::right, {0.95, 0, 1.2}, 0.5);
  motion.live({}, 0.4);
  EXPECT_GT((motion.hand() - rest).norm(), 0.1);
  person.guide_hand(Side::right, {0.95, 0, 1.2}, 0);
  motion.live({}, 2);
  EXPECT_EQ(person.phase(), PersonPhase::watching);
  EXPECT_LT((motion.hand() - rest).norm(), 0.002);
}

TEST(GuidedPerson, takes_what_is_offered_after_the_drag) {
  PersonModel person(taker());
  const PersonView view = offer({0.95, 0.05, 1.05});
  person.guide_hand(Side::right, {1.1, -0.3, 1.2}, 0.5);
  step_for(person, view, 0.4);
  EXPECT_EQ(person.phase(), PersonPhase::guided);
  step_until(person, view, PersonPhase::pulling, 8);
  EXPECT_EQ(person.phase(), PersonPhase::pulling);
  person.guide_hand(Side::right, {1.1, -0.3, 1.2}, 0.5);
  person.step(0.001, view);
  EXPECT_NE(person.phase(), PersonPhase::guided) << "a hand that exchanges an object continues";
  Motion other(person, 0);
  const Vector3 before = other.hand();
  person.guide_hand(Side::left, {1.1, 0.3, 1.2}, 0.5);
  other.live(view, 0.4);
  EXPECT_GT((other.hand() - before).norm(), 0.1) << "the other hand is free";
  EXPECT_NE(person.phase(), PersonPhase::guided);
}

TEST(GuidedPerson, frozen_person_stays_and_averted_gaze_returns) {
  PersonModel person(taker());
  const PersonView view = offer({0.2, 0, 1.05});
  step_for(person, view, 1);
  const Vector3 before = person.body().gaze_direction;
  person.look_away(1);
  step_for(person, view, 0.9);
  EXPECT_LT(person.body().gaze_direction.dot(before), 0.7);
  step_for(person, view, 1.5);
  EXPECT_GT(person.body().gaze_direction.dot(before), 0.99);
  person.freeze(true);
  Motion motion(person, 1);
  const Vector3 rest = motion.hand();
  person.guide_hand(Side::right, {0.95, 0, 1.2}, 0.5);
  motion.live(view, 0.5);
  EXPECT_LT((motion.hand() - rest).norm(), 1e-9);
}

}  // namespace
}  // namespace handsel::sim::person_guided_test
