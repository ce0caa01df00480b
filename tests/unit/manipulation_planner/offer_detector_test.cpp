#include "components/manipulation_planner/handover/offer_detector.hpp"

#include <gtest/gtest.h>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kHeldOut = 0.3, kMaxSpeed = 0.1;

class OfferDetectorTest : public testing::Test {
 protected:
  OfferDetectorTest() {
    scene_.T_world_base = Pose::Identity();
    scene_.objects.push_back({"mug", "mug", Pose::Identity(), Holder::human, "anna", 0});
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body({1.5, 0, 0}, 3.14159, 1.75);
    people_.people.push_back(anna);
    hold_at(0.35);
    set_fact(true);
  }
  void put(const Vector3& from_torso) {
    Pose& T = scene_.objects[0].T_world_object;
    T = make_pose(torso().position + from_torso);
    now_.on(scene_);
    now_.on(people_);
  }
  /// The mug toward the robot, `distance` [m] from the torso.
  void hold_at(double distance) { put({-distance, 0, 0}); }
  void set_fact(bool holds) {
    Facts facts;
    if (holds) facts.facts = {{FactKind::offering, "anna", "mug", 0.0, 1.0}};
    now_.on(facts);
  }
  void at(double time) {
    now_.set_time(TimePoint{} + from_seconds(time));
    detector_.update(p_hand_);
  }
  bool is_offered() const { return detector_.find("", "", p_hand_).has_value(); }
  BodyJoint& torso() {
    return people_.people[0].joints[static_cast<std::size_t>(body_joint_index("torso"))];
  }

  Scene scene_;
  HumanState people_;
  Snapshot now_{ObjectLibrary{}};
  OfferDetector detector_{now_, {kHeldOut, kMaxSpeed}};
  Vector3 p_hand_{0.5, 0, 1.1};
};

TEST_F(OfferDetectorTest, finds_who_offers_what_and_only_that) {
  const std::optional<Offer> offer = detector_.find("", "", p_hand_);
  ASSERT_TRUE(offer);
  EXPECT_EQ(*offer, (Offer{"mug", "anna"}));
  EXPECT_TRUE(detector_.find("mug", "anna", p_hand_));
  EXPECT_FALSE(detector_.find("box", "", p_hand_));
  EXPECT_FALSE(detector_.find("", "ben", p_hand_));
  scene_.objects[0].holder = Holder::surface;
  hold_at(0.35);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, an_object_in_motion_is_no_offer) {
  scene_.objects[0].velocity = {0, 0, 2 * kMaxSpeed};
  hold_at(0.35);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, an_accepted_offer_holds_nearer_to_the_body) {
  hold_at(kHeldOut - 0.01);
  EXPECT_FALSE(is_offered());
  hold_at(kHeldOut + 0.01);
  ASSERT_TRUE(is_offered());
  detector_.accept({"mug", "anna"});
  hold_at(kHeldOut - 0.01);
  EXPECT_TRUE(is_offered());
  hold_at(kHeldOut - 0.02);
  EXPECT_FALSE(is_offered());
  detector_.clear();
  hold_at(kHeldOut - 0.01);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, an_offer_hidden_by_noise_holds_and_a_longer_gap_ends_it) {
  at(1.0);
  detector_.accept({"mug", "anna"});
  hold_at(0.1);
  at(1.1);
  EXPECT_TRUE(detector_.is_still_offered());
  at(1.3);
  EXPECT_FALSE(detector_.is_still_offered());
  EXPECT_FALSE(detector_.is_withdrawn());
  at(1.7);
  EXPECT_TRUE(detector_.is_withdrawn());
  hold_at(0.35);
  at(1.8);
  EXPECT_TRUE(detector_.is_still_offered());
  EXPECT_FALSE(detector_.is_withdrawn());
}

TEST_F(OfferDetectorTest, a_bent_arm_counts_only_of_who_was_asked_and_toward_the_robot) {
  set_fact(false);
  hold_at(kHeldOut + 0.03);
  EXPECT_FALSE(is_offered());
  detector_.set_asked({"mug", "anna"});
  EXPECT_TRUE(is_offered());
  hold_at(kHeldOut + 0.01);
  EXPECT_FALSE(is_offered());
  put({0, kHeldOut + 0.03, 0});
  EXPECT_FALSE(is_offered()) << "beside the body";
  put({0, 0.45, 0});
  EXPECT_TRUE(is_offered()) << "farther out than anything is kept";
}

TEST_F(OfferDetectorTest, after_a_long_wait_an_object_before_the_body_counts) {
  hold_at(kHeldOut - 0.02);
  EXPECT_FALSE(is_offered());
  detector_.set_waited_long(true);
  EXPECT_TRUE(is_offered());
  hold_at(kHeldOut - 0.04);
  EXPECT_FALSE(is_offered());
}

TEST_F(OfferDetectorTest, a_fast_step_or_motion_into_the_hand_is_an_approach) {
  detector_.accept({"mug", "anna"});
  p_hand_ = torso().position - Vector3(0.65, 0, 0);  // 0.3 m before the mug
  EXPECT_FALSE(detector_.is_giver_approaching(p_hand_));
  torso().velocity = {-0.5, 0, 0};
  hold_at(0.35);
  EXPECT_TRUE(detector_.is_giver_approaching(p_hand_));
  torso().velocity = {0.5, 0, 0};
  hold_at(0.35);
  EXPECT_FALSE(detector_.is_giver_approaching(p_hand_)) << "away from the hand";
  torso().velocity.setZero();
  scene_.objects[0].velocity = {-0.5, 0, 0};
  hold_at(0.35);
  EXPECT_TRUE(detector_.is_giver_approaching(p_hand_));
  p_hand_.x() -= 0.3;
  EXPECT_FALSE(detector_.is_giver_approaching(p_hand_)) << "far from the hand";
}

TEST_F(OfferDetectorTest, the_hand_at_the_object_is_engaged_without_an_offer) {
  at(1.0);
  detector_.accept({"mug", "anna"});
  hold_at(0.1);
  at(2.0);
  EXPECT_FALSE(detector_.is_engaged());
  detector_.set_hand_at_offer(true);
  EXPECT_TRUE(detector_.is_engaged());
}

}  // namespace
}  // namespace handsel::manipulation_planner
