// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/offer_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner::offer_detector_test {
namespace {

constexpr double kMaxSpeed = 0.06;

settings::ManipulationPlannerSettings shipped() {
  return settings::read_manipulation_planner_settings(std::filesystem::path(HANDSEL_SOURCE_DIR) /
                                                      "deploy/config/manipulation_planner.txtpb");
}

class OfferDetectorTest : public testing::Test {
 protected:
  OfferDetectorTest() {
    scene_.T_world_base = Pose::Identity();
    scene_.objects.push_back({"mug", "mug", Pose::Identity(), Holder::human, "anna", 0});
    Person anna;
    anna.id = "anna";
    anna.stature = 1.75;
    anna.joints = standing_body({1.5, 0, 0}, 3.14159, 1.75);
    people_.people.push_back(anna);
    hold_at(0.30);
  }
  /// The mug in the right hand, so far from the shoulder over the stature, `aside` [rad] from the
  /// direction ahead, `up` over the stature above the shoulder.
  void hold_at(double extension, double aside = 0, double up = -0.15) {
    Person& anna = people_.people[0];
    const Vector3 p =
        joint("r_shoulder").position +
        anna.stature * Vector3(-extension * std::cos(aside), extension * std::sin(aside), up);
    scene_.objects[0].T_world_object = make_pose(p);
    joint("r_hand").position = p + Vector3(0.08, 0, 0);
    show();
  }
  void show() {
    now_.on(scene_);
    now_.on(people_);
  }
  void at(double time) {
    now_.set_time(TimePoint{} + from_seconds(time));
    detector_.update(p_hand_);
  }
  /// Moves the mug from one extension to another with a minimum-jerk profile, and steps until
  /// `rest` [s] later. Returns when it was found, since the end of the motion [s]; negative: never.
  double bring(double from, double to, double rest) {
    const double begin = clock_;
    for (; clock_ < begin + duration_ + rest; clock_ += 0.02) {
      const double s = std::min(1.0, (clock_ - begin) / duration_);
      const double along = s * s * s * (10 - 15 * s + 6 * s * s);
      hold_at(from + along * (to - from), 0, height_);
      at(clock_);
      if (detector_.made()) return clock_ - begin - duration_ + 1;
    }
    return -1;
  }
  bool is_offered() const { return detector_.find("", "", p_hand_).has_value(); }
  BodyJoint& joint(const char* name) {
    return people_.people[0].joints[static_cast<std::size_t>(body_joint_index(name))];
  }
  BodyJoint& torso() { return joint("torso"); }

  Scene scene_;
  HumanState people_;
  Snapshot now_{ObjectLibrary{}};
  settings::ManipulationPlannerSettings settings_ = shipped();
  OfferDetector detector_{now_, settings_};
  Vector3 p_hand_{0.35, 0, 1.1};
  double clock_{1.0};
  double duration_{0.9};  // duration of a motion [s]
  double height_{-0.15};  // height of the moving mug above the shoulder, divided by the stature
};

TEST_F(OfferDetectorTest, finds_who_offers_what_and_only_that) {
  const std::optional<Offer> offer = detector_.find("", "", p_hand_);
  ASSERT_TRUE(offer);
  EXPECT_EQ(*offer, (Offer{"mug", "anna"}));
  EXPECT_TRUE(detector_.find("mug", "anna", p_hand_));
  EXPECT_FALSE(detector_.find("box", "", p_hand_));
  EXPECT_FALSE(detector_.find("", "ben", p_hand_));
  scene_.objects[0].holder = Holder::surface;
  hold_at(0.30);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, an_object_in_motion_is_no_offer) {
  scene_.objects[0].velocity = {0, 0, 2 * kMaxSpeed};
  hold_at(0.30);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, what_is_kept_raised_or_held_aside_is_no_offer) {
  hold_at(0.18);
  EXPECT_FALSE(is_offered()) << "before the body";
  hold_at(0.30, 0, 0.02);
  EXPECT_FALSE(is_offered()) << "at the mouth or before the eyes";
  hold_at(0.30, 0, -0.27);
  EXPECT_FALSE(is_offered()) << "hanging, or at a table that is not known";
  hold_at(0.30, 1.2);
  EXPECT_FALSE(is_offered()) << "aside";
  hold_at(0.30, 0.3);
  EXPECT_TRUE(is_offered());
}

TEST_F(OfferDetectorTest, what_is_extended_at_rest_to_another_person_is_no_offer) {
  Person ben = people_.people[0];
  ben.id = "ben";
  ben.joints = standing_body({0.75, 0.25, 0}, 0, 1.75);
  people_.people.push_back(ben);
  hold_at(0.30, 0.1);
  EXPECT_FALSE(is_offered());
  people_.people[1].joints = standing_body({-0.9, 0.45, 0}, 0, 1.75);
  hold_at(0.30, 0.1);
  EXPECT_TRUE(is_offered()) << "ben is too far away";
  people_.people.pop_back();
  hold_at(0.30, 0.1);
  EXPECT_TRUE(is_offered());
}

TEST_F(OfferDetectorTest, before_the_robots_hand_a_bent_arm_counts) {
  hold_at(0.23);
  EXPECT_FALSE(is_offered());
  p_hand_ = scene_.objects[0].T_world_object.translation() - Vector3(0.42, 0, 0);
  EXPECT_TRUE(is_offered());
}

TEST_F(OfferDetectorTest, before_the_robots_hand_an_arm_bent_more_counts_after_a_long_rest) {
  hold_at(0.195);
  p_hand_ = scene_.objects[0].T_world_object.translation() - Vector3(0.42, 0, 0);
  EXPECT_LT(bring(0.195, 0.195, 4.0), 0) << "kept there, not offered";
  EXPECT_LT(bring(0.195, 0.12, 0.0), 0);
  const double found = bring(0.12, 0.195, 4.0);
  EXPECT_GT(found, 1 + 1.5);
  EXPECT_LT(found, 1 + 2.2);
}

TEST_F(OfferDetectorTest, what_is_extended_at_rest_low_or_high_counts_after_a_long_rest) {
  height_ = -0.27;
  EXPECT_LT(bring(0.29, 0.29, 4.0), 0) << "hanging there all the time";
  const auto is_found = [&](double extension, double height) {
    height_ = height;
    detector_.await();
    EXPECT_LT(bring(extension, 0.12, 0.0), 0);
    const double found = bring(0.12, extension, 4.0);
    EXPECT_TRUE(found < 0 || (found > 1 + 1.5 && found < 1 + 2.2)) << found;
    return found > 0;
  };
  EXPECT_TRUE(is_found(0.29, -0.27));
  EXPECT_FALSE(is_found(0.29, -0.30));
  EXPECT_TRUE(is_found(0.34, 0.05));
  EXPECT_FALSE(is_found(0.34, 0.09));
  EXPECT_FALSE(is_found(0.29, 0.02)) << "before the eyes";
}

TEST_F(OfferDetectorTest, over_a_table_what_is_extended_at_long_rest_may_be_above_the_shoulder) {
  const auto is_found = [&](double height) {
    height_ = height;
    detector_.await();
    EXPECT_LT(bring(0.29, 0.12, 0.0), 0);
    return bring(0.12, 0.29, 4.0) > 1 + 1.5;
  };
  EXPECT_FALSE(is_found(0.06));
  const Vector3 p_object = scene_.objects[0].T_world_object.translation();
  const auto table_at = [&](double below) {
    const double top = p_object.z() - below;
    scene_.boxes = {
        {"table", make_pose({p_object.x(), p_object.y(), top / 2}), {0.8, 0.8, top}, true}};
  };
  table_at(0.2);
  EXPECT_TRUE(is_found(0.06));
  table_at(0.3);
  EXPECT_FALSE(is_found(0.06)) << "there is room enough below";
  table_at(0.2);
  scene_.boxes[0].T_world_box.translation().x() += 0.6;
  EXPECT_TRUE(is_found(0.06)) << "the forearm is over the table";
  scene_.boxes[0].T_world_box.translation().x() += 0.4;
  EXPECT_FALSE(is_found(0.06)) << "the table is elsewhere";
}

TEST_F(OfferDetectorTest, what_is_extended_at_rest_farther_may_be_higher) {
  hold_at(0.28, 0, -0.02);
  EXPECT_FALSE(is_offered());
  hold_at(0.32, 0, -0.02);
  EXPECT_TRUE(is_offered());
  hold_at(0.32, 0, 0.01);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, an_accepted_offer_holds_nearer_to_the_body) {
  detector_.accept({"mug", "anna"});
  hold_at(0.275);
  EXPECT_TRUE(is_offered());
  hold_at(0.25);
  EXPECT_FALSE(is_offered());
  hold_at(0.27);
  EXPECT_TRUE(is_offered());
  detector_.clear();
  EXPECT_FALSE(is_offered());
  hold_at(0.276);
  detector_.accept({"mug", "anna"});
  hold_at(0.26);
  EXPECT_TRUE(is_offered()) << "hardly nearer than when it was accepted";
}

TEST_F(OfferDetectorTest, an_accepted_offer_holds_farther_aside) {
  hold_at(0.30, 0.8);
  EXPECT_FALSE(is_offered());
  detector_.accept({"mug", "anna"});
  EXPECT_TRUE(is_offered());
  hold_at(0.30, 1.2);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, an_offer_seen_before_may_be_nearer_by_the_noise) {
  const auto is_seen_at = [&](double extension) {
    hold_at(extension);
    at(clock_ += 0.02);
    return detector_.is_seen();
  };
  EXPECT_FALSE(is_seen_at(0.268));
  EXPECT_TRUE(is_seen_at(0.28));
  EXPECT_TRUE(is_seen_at(0.268));
  EXPECT_FALSE(is_seen_at(0.26));
}

TEST_F(OfferDetectorTest, only_what_was_asked_for_is_awaited) {
  detector_.set_asked({"box", ""});
  EXPECT_LT(bring(0.15, 0.30, 1.0), 0);
  detector_.set_asked({"mug", "anna"});
  EXPECT_GT(bring(0.30, 0.30, 0.0), 0);
  detector_.await();
  EXPECT_FALSE(detector_.made()) << "not observed since";
}

TEST_F(OfferDetectorTest, an_accepted_offer_long_rest_rise_farther_ends_sooner_on_its_way_back) {
  hold_at(0.28);
  detector_.accept({"mug", "anna"});
  hold_at(0.27);
  EXPECT_TRUE(is_offered());
  for (; clock_ < 2; clock_ += 0.05) {
    hold_at(0.33);
    at(clock_);
  }
  hold_at(0.27);
  EXPECT_FALSE(is_offered());
  hold_at(0.29);
  EXPECT_TRUE(is_offered());
  hold_at(0.40);
  at(clock_);
  hold_at(0.32);
  EXPECT_TRUE(is_offered()) << "one observation farther out may be noise";
}

TEST_F(OfferDetectorTest, an_offer_is_made_soon_after_the_object_has_come_to_rest) {
  const double found = bring(0.15, 0.30, 1.0);
  EXPECT_GT(found, 1.0);
  EXPECT_LT(found, 1.25);
}

TEST_F(OfferDetectorTest, a_motion_out_and_back_at_once_is_no_offer) {
  EXPECT_LT(bring(0.15, 0.30, 0.0), 0);
  EXPECT_LT(bring(0.30, 0.15, 0.5), 0);
}

TEST_F(OfferDetectorTest, what_was_moved_about_must_rest_longer) {
  duration_ = 0.35;
  EXPECT_LT(bring(0.15, 0.30, 0.0), 0);
  EXPECT_LT(bring(0.30, 0.15, 0.0), 0);
  const double found = bring(0.15, 0.30, 1.0);
  EXPECT_GT(found, 1.25);
  EXPECT_LT(found, 1.5);
}

TEST_F(OfferDetectorTest, what_another_persons_hand_is_at_is_no_offer) {
  Person ben = people_.people[0];
  ben.id = "ben";
  ben.joints = standing_body({2.5, 1.0, 0}, 3.14159, 1.75);
  people_.people.push_back(ben);
  hold_at(0.30);
  EXPECT_TRUE(is_offered()) << "ben stands behind";
  const Vector3 p = scene_.objects[0].T_world_object.translation();
  people_.people[1].joints[static_cast<std::size_t>(body_joint_index("r_hand"))].position =
      p + Vector3(0, 0.15, 0);
  hold_at(0.30);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, only_new_observations_show_a_rest) {
  EXPECT_LT(bring(0.15, 0.30, 0.1), 0);
  const double last = clock_;
  for (; clock_ < last + 0.5; clock_ += 0.02) {
    scene_.objects[0].age = clock_ - last;
    show();
    at(clock_);
  }
  EXPECT_FALSE(detector_.made()) << "not seen since";
  scene_.objects[0].age = 0;
  EXPECT_GE(bring(0.30, 0.30, 0.1), 0);
}

TEST_F(OfferDetectorTest, the_path_counts_from_before_the_person_was_seen_to_hold_the_object) {
  scene_.objects[0].holder = Holder::nobody;
  EXPECT_LT(bring(0.15, 0.30, 0.0), 0);
  scene_.objects[0].holder = Holder::human;
  EXPECT_LT(bring(0.30, 0.27, 0.0), 0) << "out and slowly back at once";
}

TEST_F(OfferDetectorTest, the_rest_counts_from_when_the_person_was_seen_to_hold_the_object) {
  scene_.objects[0].holder = Holder::nobody;
  EXPECT_LT(bring(0.30, 0.30, 0.1), 0);
  scene_.objects[0].holder = Holder::human;
  const double begin = clock_;
  EXPECT_GT(bring(0.30, 0.30, 0.1), 0);
  EXPECT_GT(clock_, begin + 0.15);
}

TEST_F(OfferDetectorTest, an_offer_hidden_by_noise_holds_and_a_longer_gap_ends_it) {
  at(1.0);
  detector_.accept({"mug", "anna"});
  hold_at(0.15);
  at(1.1);
  EXPECT_TRUE(detector_.is_still_offered());
  at(1.3);
  EXPECT_FALSE(detector_.is_still_offered());
  EXPECT_FALSE(detector_.is_withdrawn());
  at(1.7);
  EXPECT_TRUE(detector_.is_withdrawn());
  hold_at(0.30);
  at(1.8);
  EXPECT_TRUE(detector_.is_still_offered());
  EXPECT_FALSE(detector_.is_withdrawn());
}

TEST_F(OfferDetectorTest, a_fast_step_or_motion_into_the_hand_is_an_approach) {
  detector_.accept({"mug", "anna"});
  p_hand_ = scene_.objects[0].T_world_object.translation() - Vector3(0.3, 0, 0);
  EXPECT_FALSE(detector_.is_giver_approaching(p_hand_));
  torso().velocity = {-0.5, 0, 0};
  hold_at(0.30);
  EXPECT_TRUE(detector_.is_giver_approaching(p_hand_));
  torso().velocity = {0.5, 0, 0};
  hold_at(0.30);
  EXPECT_FALSE(detector_.is_giver_approaching(p_hand_)) << "away from the hand";
  torso().velocity.setZero();
  scene_.objects[0].velocity = {-0.5, 0, 0};
  hold_at(0.30);
  EXPECT_TRUE(detector_.is_giver_approaching(p_hand_));
  p_hand_.x() -= 0.3;
  EXPECT_FALSE(detector_.is_giver_approaching(p_hand_)) << "far from the hand";
}

TEST_F(OfferDetectorTest, the_hand_at_the_object_is_engaged_without_an_offer) {
  at(1.0);
  detector_.accept({"mug", "anna"});
  hold_at(0.15);
  at(2.0);
  EXPECT_FALSE(detector_.is_engaged());
  detector_.set_hand_at_offer(true);
  EXPECT_TRUE(detector_.is_engaged());
}

}  // namespace
}  // namespace handsel::manipulation_planner::offer_detector_test
