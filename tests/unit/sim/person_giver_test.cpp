// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/model/object_surface.hpp"
#include "tests/unit/sim/person_fixture.hpp"

namespace handsel::sim::person_giver_test {
namespace {

using namespace test;

PersonSettings giver() {
  PersonSettings settings;
  settings.id = "anna";
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  settings.kind = PersonKind::giver;
  return settings;
}

/// Returns a giver's view while the mug moves with the hand.
PersonView holding(const PersonModel& person, const Vector3& robot_hand, bool robot_holds_it) {
  PersonView view = offer(person.hand().T_world_body * Vector3(0.08, 0, 0));
  view.robot_hand = robot_hand;
  view.held_by_robot = view.held_firmly = robot_holds_it;
  return view;
}

void live(PersonModel& person, double seconds, const Vector3& robot_hand,
          bool robot_holds_it = false) {
  for (int i = 0; i < static_cast<int>(seconds * 1000); ++i)
    person.step(0.001, holding(person, robot_hand, robot_holds_it));
}

TEST(SimPerson, who_gives_holds_it_out_toward_the_robot_and_lets_go_once_the_robot_has_it) {
  PersonModel person(giver());
  const Vector3 robot_hand(0.4, 0.3, 1.0);
  const double before = (person.hand().T_world_body.translation() - robot_hand).norm();
  EXPECT_TRUE(person.wants_grip());
  live(person, 3, robot_hand);
  EXPECT_EQ(person.phase(), PersonPhase::offering);
  EXPECT_LT((person.hand().T_world_body.translation() - robot_hand).norm(), before - 0.15);
  live(person, 0.4, robot_hand, true);
  EXPECT_TRUE(person.wants_grip()) << "not at the first touch";
  live(person, 0.3, robot_hand, true);
  EXPECT_FALSE(person.wants_grip());
  live(person, 2, robot_hand, true);
  EXPECT_EQ(person.phase(), PersonPhase::watching);
}

TEST(SimPerson, who_gives_holds_with_the_digits_opens_them_and_leaves_behind_the_palm) {
  PersonModel person(giver());
  const ObjectModel& mug = *library()("mug");
  const auto T_hand_object = person.hold_from_beginning(mug, Eigen::Quaterniond::Identity());
  ASSERT_TRUE(T_hand_object);
  const auto held = [&](bool robot_holds_it) {
    PersonView view = offer({0.4, 0.3, 1.0});
    view.robot_hand = {0.4, 0.3, 1.0};
    view.T_world_object = person.hand().T_world_body * *T_hand_object;
    view.held_by_robot = view.held_firmly = robot_holds_it;
    return view;
  };
  for (int i = 0; i < 3000; ++i) person.step(0.001, held(false));
  ASSERT_EQ(person.phase(), PersonPhase::offering);
  ASSERT_TRUE(person.hand_configuration());
  const HandConfiguration holding_hand = *person.hand_configuration();
  int digits_in_contact = 0;
  const Pose T_object_world = held(false).T_world_object.inverse();
  const Pose T_hand =
      make_pose(person.hand().T_world_body.translation(), holding_hand.R_world_hand);
  for (int d = 0; d < kDigits; ++d) {
    double gap = 1;
    for (const HandPart& part : person.hand_shape(1).digit(d, holding_hand.closures[d]))
      gap = std::min(gap, surface_distance(mug, transformed(T_object_world * T_hand, part)));
    EXPECT_GT(gap, -0.006) << d;
    digits_in_contact += gap < 0.001 ? 1 : 0;
  }
  EXPECT_GE(digits_in_contact, 3);
  const Vector3 wrist = person.body().joints[joint("r_wrist")].position;
  EXPECT_LT(((T_hand.translation() - wrist).normalized() - T_hand.linear().col(2)).norm(), 0.05)
      << "the wrist is where the fingers' direction says";
  // The robot holds the mug, the person releases it and leaves.
  const PersonView taken = held(true);
  while (person.phase() == PersonPhase::offering) person.step(0.001, taken);
  ASSERT_EQ(person.phase(), PersonPhase::retracting);
  auto before = person.hand_configuration()->closures;
  double before_gap = -1;
  for (int i = 0; i < 400; ++i) {
    person.step(0.001, taken);
    ASSERT_TRUE(person.hand_configuration());
    const auto& now = person.hand_configuration()->closures;
    for (int d = 0; d < kDigits; ++d) {
      ASSERT_LE(now[d], before[d]);
      ASSERT_LT(before[d] - now[d], 0.01) << "a digit opens in no time";
    }
    before = now;
    const double gap = surface_distance(
        mug, taken.T_world_object.inverse() * person.hand().T_world_body.translation());
    ASSERT_GT(gap, before_gap - 1e-4) << "the palm comes back after " << i << " ms";
    before_gap = gap;
  }
  EXPECT_EQ(before, Closures{});
}

TEST(SimPerson, who_gives_keeps_what_the_robot_only_touches) {
  PersonModel person(giver());
  const Vector3 robot_hand(0.4, 0.3, 1.0);
  live(person, 3, robot_hand);
  for (int i = 0; i < 3000; ++i) {
    PersonView view = holding(person, robot_hand, true);
    view.held_firmly = false;
    person.step(0.001, view);
  }
  EXPECT_TRUE(person.wants_grip());
  live(person, 0.7, robot_hand, true);
  EXPECT_FALSE(person.wants_grip());
}

TEST(SimPerson, giver_takes_back_what_the_robot_hands_back_and_offers_it_when_asked) {
  PersonModel person(giver());
  live(person, 3, {0.4, 0.3, 1.0});
  live(person, 0.7, {0.4, 0.3, 1.0}, true);
  ASSERT_FALSE(person.wants_grip());
  const PersonView view = offer({0.95, 0.05, 1.05});
  for (int i = 0; i < 5000; ++i) person.step(0.001, view);
  ASSERT_EQ(person.phase(), PersonPhase::watching) << "the robot does not hand it back";
  person.announce(Announcement::offers);
  for (int i = 0; i < 6000 && person.phase() != PersonPhase::pulling; ++i) person.step(0.001, view);
  ASSERT_EQ(person.phase(), PersonPhase::pulling);
  person.announce(Announcement::asks);
  live(person, 6, {0.4, 0.5, 1.0});
  EXPECT_EQ(person.phase(), PersonPhase::offering);
}

TEST(SimPerson, giver_who_moves_and_is_ignored_then_holds_it_out_anew_upright) {
  PersonSettings settings = giver();
  settings.moving.duration = 3;
  settings.moving.start_low = settings.moving.next_low = Vector3(0.86, -0.3, 0.9);
  settings.moving.start_high = settings.moving.next_high = Vector3(1.06, 0.3, 1.1);
  settings.moving.spread = 0.1;
  settings.moving.min_speed = settings.moving.max_speed = 0.1;
  settings.moving.min_turn_speed = settings.moving.max_turn_speed = 0.3;
  settings.moving.max_turn = 0.9;
  settings.moving.seed = 3;
  PersonModel person(settings);
  const Vector3 robot_hand(0.3, 0.3, 1.0);
  const auto turn = [&] {
    const Eigen::Quaterniond facing(Eigen::AngleAxisd(settings.yaw, Vector3::UnitZ()));
    return facing.angularDistance(Eigen::Quaterniond(person.hand().T_world_body.linear()));
  };
  live(person, 8, robot_hand);
  EXPECT_GT(turn(), 0.3);
  const Vector3 stays = person.hand().T_world_body.translation();
  live(person, 2, robot_hand);
  EXPECT_LT((person.hand().T_world_body.translation() - stays).norm(), 0.01);
  live(person, 12, robot_hand);
  EXPECT_EQ(person.phase(), PersonPhase::offering);
  EXPECT_LT(turn(), 0.02);
}

TEST(SimPerson, partner_takes_and_gives_back_when_asked_again_and_again) {
  PersonSettings settings = giver();
  settings.feet = Vector3(1.35, 0, 0);
  settings.kind = PersonKind::partner;
  PersonModel person(settings);
  const Vector3 aside(0.4, 0.5, 1.0);
  for (int round = 0; round < 3; ++round) {
    const PersonView view = offer({0.95, 0.05, 1.05});
    for (int i = 0; i < 3000; ++i) person.step(0.001, view);
    ASSERT_EQ(person.phase(), PersonPhase::watching) << "the robot does not offer the mug";
    person.announce(Announcement::offers);
    for (int i = 0; i < 6000 && person.phase() != PersonPhase::pulling; ++i)
      person.step(0.001, view);
    ASSERT_EQ(person.phase(), PersonPhase::pulling) << round;
    live(person, 4, aside);
    EXPECT_EQ(person.phase(), PersonPhase::keeping) << round;
    live(person, 4, aside);
    EXPECT_EQ(person.phase(), PersonPhase::keeping) << "unasked";
    const Vector3 kept = person.hand().T_world_body.translation();

    person.announce(Announcement::asks);
    live(person, 1.5 * settings.reaction, aside);
    person.announce(Announcement::none);
    live(person, 2, aside);
    EXPECT_EQ(person.phase(), PersonPhase::keeping) << "the robot no longer asks";
    const Vector3 moved = person.hand().T_world_body.translation() - kept;
    EXPECT_LT(moved.cwiseProduct(Vector3(0, 1, 1)).norm(), 1e-3);
    EXPECT_LE(std::abs(moved.x()), 0.2) << "no more than the step forward again";

    person.announce(Announcement::asks);
    live(person, 4, aside);
    EXPECT_EQ(person.phase(), PersonPhase::offering) << round;
    EXPECT_GT((person.hand().T_world_body.translation() - kept).norm(), 0.15);
    live(person, 0.8, aside, true);
    person.announce(Announcement::none);
    for (int i = 0; i < 4000; ++i) person.step(0.001, PersonView{});
    EXPECT_EQ(person.phase(), PersonPhase::watching);
    EXPECT_FALSE(person.wants_grip());
    EXPECT_NEAR(person.body().joints[static_cast<std::size_t>(joint("torso"))].position.x(), 1.35,
                0.1)
        << "where it stood at first";
  }
}

/// A partner who has taken the mug, with the robot's hand far away.
class PartnerWithMug {
 public:
  PartnerWithMug() : view_(offer({0.95, 0.05, 1.05})), person_(settings()) {
    person_.announce(Announcement::offers);
    step_until(person_, view_, PersonPhase::pulling, 6);
    T_hand_object_ = person_.hand().T_world_body.inverse() * view_.T_world_object;
    view_.robot_hand = {0.3, 0.5, 1.0};
    view_.held_by_robot = view_.held_firmly = false;
  }
  /// Steps the person; the object follows the hand and its wanted pose in the hand.
  void live(double duration) {
    for (int i = 0; i < 1000 * duration; ++i) {
      view_.T_world_object = person_.hand().T_world_body * T_hand_object_;
      view_.p_hand_object = T_hand_object_.translation();
      person_.step(0.001, view_);
      if (person_.p_hand_object_to_give())
        T_hand_object_.translation() = *person_.p_hand_object_to_give();
    }
  }
  PersonModel& person() { return person_; }
  double hand_above_middle() const {
    const Vector3 p_object =
        person_.hand().T_world_body * T_hand_object_ * Vector3(view_.object->com);
    return person_.hand().T_world_body.translation().z() - p_object.z();
  }
  /// Pose of the palm in the frame of the object.
  Pose T_object_palm() const {
    Pose T_world_palm = person_.hand().T_world_body;
    T_world_palm.linear() = person_.hand_configuration()->R_world_hand.toRotationMatrix();
    return (person_.hand().T_world_body * T_hand_object_).inverse() * T_world_palm;
  }

 private:
  static PersonSettings settings() {
    PersonSettings out = giver();
    out.feet = Vector3(1.35, 0, 0);
    out.kind = PersonKind::partner;
    return out;
  }
  PersonView view_;
  PersonModel person_;
  Pose T_hand_object_{Pose::Identity()};
};

TEST(SimPerson, partner_holds_anew_what_the_robot_asks_for_and_leaves_room_at_its_upper_end) {
  PartnerWithMug partner;
  ASSERT_EQ(partner.person().phase(), PersonPhase::pulling);
  EXPECT_TRUE(partner.person().hand_configuration()) << "taken with the digits";
  partner.live(4);
  ASSERT_EQ(partner.person().phase(), PersonPhase::keeping);
  EXPECT_TRUE(partner.person().hand_configuration());
  EXPECT_FALSE(partner.person().p_hand_object_to_give());
  partner.person().announce(Announcement::asks);
  partner.live(4);
  ASSERT_EQ(partner.person().phase(), PersonPhase::offering);
  ASSERT_TRUE(partner.person().p_hand_object_to_give());
  EXPECT_TRUE(partner.person().hand_configuration());
  EXPECT_LT(partner.hand_above_middle(), 0.02) << "of a mug 0.1 m high";
}

TEST(SimPerson, partner_whose_offer_is_not_taken_holds_it_otherwise) {
  PartnerWithMug partner;
  partner.live(4);
  partner.person().announce(Announcement::asks);
  partner.live(6);
  ASSERT_EQ(partner.person().phase(), PersonPhase::offering);
  const Pose first = partner.T_object_palm();
  partner.live(12);
  ASSERT_EQ(partner.person().phase(), PersonPhase::offering);
  const Pose second = partner.T_object_palm();
  const double moved = (second.translation() - first.translation()).norm();
  const double cosine = second.linear().col(0).dot(first.linear().col(0));
  EXPECT_TRUE(moved > 0.05 || cosine < 0.7) << moved << " m, " << cosine;
}

TEST(SimPerson, partner_who_offered_in_vain_holds_the_object_otherwise_when_asked_again) {
  PartnerWithMug partner;
  partner.live(4);
  partner.person().announce(Announcement::asks);
  partner.live(4);
  ASSERT_EQ(partner.person().phase(), PersonPhase::offering);
  const Pose first = partner.T_object_palm();
  partner.person().announce(Announcement::none);
  partner.live(4);
  ASSERT_EQ(partner.person().phase(), PersonPhase::keeping);
  partner.person().announce(Announcement::asks);
  partner.live(4);
  ASSERT_EQ(partner.person().phase(), PersonPhase::offering);
  const Pose second = partner.T_object_palm();
  const double moved = (second.translation() - first.translation()).norm();
  const double cosine = second.linear().col(0).dot(first.linear().col(0));
  EXPECT_TRUE(moved > 0.05 || cosine < 0.7) << moved << " m, " << cosine;
}

TEST(SimPerson, giver_whose_offer_is_ignored_beside_the_robots_hand_draws_it_back_to_hold_it_anew) {
  PersonModel person(giver());
  const auto first_hold =
      person.hold_from_beginning(*library()("mug"), Eigen::Quaterniond::Identity());
  ASSERT_TRUE(first_hold);
  Pose T_hand_object = *first_hold;
  Vector3 robot_hand(0.3, 0, 1.0);
  const auto live_with_mug = [&](double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
      if (person.p_hand_object_to_give())
        T_hand_object.translation() = *person.p_hand_object_to_give();
      PersonView view = holding(person, robot_hand, false);
      view.T_world_object = person.hand().T_world_body * T_hand_object;
      view.p_hand_object = T_hand_object.translation();
      person.step(0.001, view);
    }
  };
  const auto palm = [&] {
    const Pose T_world_palm = make_pose(person.hand().T_world_body.translation(),
                                        person.hand_configuration()->R_world_hand);
    return Pose((person.hand().T_world_body * T_hand_object).inverse() * T_world_palm);
  };
  live_with_mug(4);
  ASSERT_EQ(person.phase(), PersonPhase::offering);
  const Pose first = palm();
  robot_hand = person.hand().T_world_body * T_hand_object.translation() - Vector3(0.44, 0, 0);
  bool drawn_back = false;
  for (int i = 0; i < 140; ++i) {
    live_with_mug(0.1);
    drawn_back = drawn_back || person.phase() == PersonPhase::keeping;
  }
  EXPECT_TRUE(drawn_back);
  ASSERT_EQ(person.phase(), PersonPhase::offering);
  const Pose second = palm();
  const double moved = (second.translation() - first.translation()).norm();
  const double cosine = second.linear().col(0).dot(first.linear().col(0));
  EXPECT_TRUE(moved > 0.05 || cosine < 0.7) << moved << " m, " << cosine;
}

TEST(SimPerson, giver_does_not_step_aside_while_the_robots_hand_presses_on_the_object) {
  PersonSettings settings = giver();
  settings.behaviour.sidestep = Vector3(0, 0.2, 0);
  settings.behaviour.sidestep_at = 3;
  PersonModel person(settings);
  const auto torso = [&] { return person.body().joints[joint("torso")].position.y(); };
  const double before = torso();
  const auto live_pressed = [&](double seconds, bool pressed) {
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
      PersonView view = holding(person, {0.4, 0.3, 1.0}, false);
      view.pressed_by_robot = pressed;
      person.step(0.001, view);
    }
  };
  live_pressed(2, false);
  ASSERT_EQ(person.phase(), PersonPhase::offering);
  live_pressed(3, true);
  EXPECT_NEAR(torso(), before, 0.01);
  live_pressed(2, false);
  EXPECT_NEAR(torso(), before + 0.2, 0.02);
}

TEST(SimPerson, who_gives_never_holds_it_into_the_robots_hand) {
  PersonModel person(giver());
  live(person, 3, {1.0, -0.2, 1.2});
  EXPECT_GT((person.hand().T_world_body.translation() - Vector3(1.0, -0.2, 1.2)).norm(), 0.3);
}

TEST(SimPerson, who_holds_something_keeps_it_above_the_table_they_sit_at) {
  PersonSettings settings = giver();
  settings.behaviour.seated = true;
  PersonModel free(settings);
  const Vector3 where = free.hand().T_world_body.translation();
  EXPECT_LT(where.z(), 0.8);
  const Furniture table{make_pose({where.x() - 0.2, where.y(), 0.36}), {0.5, 0.5, 0.72}},
      far{make_pose({where.x() - 5, 0, 0.36}), {1, 1, 2}},
      shelf{make_pose({where.x(), where.y(), 1.6}), {0.5, 0.5, 0.1}},
      beside{make_pose({where.x(), where.y() + 0.6, 0.8}), {0.8, 0.3, 1.6}};
  settings.furniture = {far, shelf, beside};
  PersonModel same(settings);
  EXPECT_EQ(same.hand().T_world_body.translation(), where);
  settings.furniture.push_back(table);
  PersonModel person(settings);
  Vector3 before = person.hand().T_world_body.translation();
  for (int i = 0; i < 20000; ++i) {
    person.step(0.001, holding(person, {0.3, 0.4, 1.0}, false));
    const Vector3 hand = person.hand().T_world_body.translation();
    ASSERT_GT(hand.z(), 0.72 + 0.1) << i;
    ASSERT_LT((hand - before).norm(), 0.004) << i;
    before = hand;
  }
}

TEST(SimPerson, who_is_ignored_comes_nearer_and_holds_it_out_anew_twice) {
  PersonModel person(giver());
  const double before = person.body().joints[joint("torso")].position.x();
  live(person, 40, {0.3, 0, 1.0});
  EXPECT_NEAR(before - person.body().joints[joint("torso")].position.x(), 0.24, 0.03);
  EXPECT_EQ(person.phase(), PersonPhase::offering);
}

TEST(SimPerson, who_is_ignored_steps_nearer_only_where_the_robots_hand_leaves_room) {
  PersonModel person(giver());
  const Vector3 robot_hand(0.66, -0.1, 1.05);
  live(person, 8, robot_hand);
  const auto extension = [&] {
    return (person.hand().T_world_body.translation() -
            person.body().joints[joint("r_shoulder")].position)
        .head<2>()
        .norm();
  };
  const double before = extension();
  double nearest = 1;
  for (int i = 0; i < 40000; ++i) {
    person.step(0.001, holding(person, robot_hand, false));
    nearest = std::min(nearest, (person.hand().T_world_body.translation() - robot_hand).norm());
  }
  EXPECT_GT(nearest, 0.43) << "the object is within the fingers' length of the palm";
  EXPECT_GT(extension(), before - 0.03) << "the arm was bent for a step";
}

/// The stop proof assumes that a trunk accelerates by at most 10 m/s^2
/// (StopProofSettings::people).
TEST(SimPerson, a_step_nearer_is_no_faster_than_people_step) {
  PersonModel person(giver());
  Vector3 before = Vector3::Zero();
  double fastest = 0, most = 0;
  for (int i = 0; i < 40000; ++i) {
    person.step(0.001, holding(person, {0.3, 0, 1.0}, false));
    const Vector3 velocity = person.body().joints[joint("torso")].velocity;
    if (i > 1) most = std::max(most, (velocity - before).norm() / 0.001);
    fastest = std::max(fastest, velocity.norm());
    before = velocity;
  }
  EXPECT_LT(most, 4.5);
  EXPECT_GT(fastest, 0.3) << "no step was made";
}

TEST(SimPerson, who_changes_their_mind_draws_it_back_once_and_offers_again) {
  PersonSettings settings = giver();
  settings.behaviour.withdraws = true;
  PersonModel person(settings);
  live(person, 4, {0.4, 0, 1.0});
  ASSERT_EQ(person.phase(), PersonPhase::offering);
  const Vector3 near = person.hand().T_world_body.translation() + Vector3(-0.25, 0, 0);
  live(person, 0.5, near);
  EXPECT_EQ(person.phase(), PersonPhase::keeping);
  EXPECT_TRUE(person.wants_grip());
  live(person, 6, near);
  EXPECT_EQ(person.phase(), PersonPhase::offering) << "and now stays";
}

}  // namespace
}  // namespace handsel::sim::person_giver_test
