// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/human_body.hpp"
#include "common/model/human/holding_hand.hpp"

#include <gtest/gtest.h>

#include <random>

namespace handsel::human_body_test {
namespace {

Person person_at(const Vector3& feet, double yaw, double stature = 1.75) {
  Person person;
  person.id = "anna";
  person.stature = stature;
  person.joints = standing_body(feet, yaw, stature);
  return person;
}

ObservedPerson observe(const Person& person, const std::vector<std::string>& names) {
  ObservedPerson seen;
  for (const auto& name : names)
    seen.joints.push_back({name, person.joints.at(body_joint_index(name)).position, 0.9});
  return seen;
}

double off(const std::vector<BodyJoint>& joints, const Person& person, const std::string& name) {
  const int i = body_joint_index(name);
  return (joints.at(i).position - person.joints.at(i).position).norm();
}

bool inside(const BodyCapsule& c, const Vector3& p) {
  const Vector3 d = c.b - c.a;
  const double t =
      d.squaredNorm() > 0 ? std::clamp((p - c.a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - c.a - t * d).norm() <= c.radius + 1e-9;
}

TEST(HumanBody, joints_are_in_order_and_left_is_left) {
  const Person p = person_at({1, 2, 0}, 0);
  ASSERT_EQ(p.joints.size(), kBodyJoints.size());
  for (std::size_t i = 0; i < kBodyJoints.size(); ++i) EXPECT_EQ(p.joints[i].name, kBodyJoints[i]);
  EXPECT_GT(p.joints[body_joint_index("l_shoulder")].position.y(),
            p.joints[body_joint_index("r_shoulder")].position.y());
  EXPECT_EQ(body_joint_index("tail"), -1);
}

TEST(HumanBody, capsules_cover_every_joint_and_the_top_of_the_head) {
  const Person p = person_at({0, 0, 0}, 0.7);
  const auto capsules = body_capsules(p);
  for (const auto& joint : p.joints) {
    bool covered = false;
    for (const auto& c : capsules) covered |= inside(c, joint.position);
    EXPECT_TRUE(covered) << joint.name;
  }
  double top = 0;
  for (const auto& c : capsules) top = std::max({top, c.a.z() + c.radius, c.b.z() + c.radius});
  EXPECT_GE(top, p.stature);
  EXPECT_LT(top, p.stature * 1.05);
}

TEST(HumanBody, inflation_grows_every_capsule) {
  Person p = person_at({0, 0, 0}, 0);
  const auto before = body_capsules(p);
  p.inflation = 0.1;
  const auto after = body_capsules(p);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_NEAR(after[i].radius, before[i].radius + 0.1, 1e-12);
}

TEST(HumanBody, nobody_has_no_capsules) { EXPECT_TRUE(body_capsules(Person{}).empty()); }

TEST(FitBody, complete_observations_are_kept) {
  const Person truth = person_at({1.2, 0.3, 0}, 2.5);
  ObservedPerson seen;
  for (const auto& joint : truth.joints) seen.joints.push_back({joint.name, joint.position, 1.0});
  const auto fitted = fit_body(seen, nullptr, 1.75);
  for (const auto& joint : truth.joints) EXPECT_LT(off(fitted, truth, joint.name), 1e-9);
}

TEST(FitBody, trunk_and_head_place_the_unseen_rest) {
  const Person truth = person_at({1.2, -0.4, 0}, -2.9);
  const auto fitted = fit_body(
      observe(truth, {"head", "neck", "torso", "l_shoulder", "r_shoulder"}), nullptr, 1.75);
  for (const auto& joint : truth.joints)
    EXPECT_LT(off(fitted, truth, joint.name), 0.02) << joint.name;
}

TEST(FitBody, one_joint_and_the_gaze_are_enough_to_stand) {
  const Person truth = person_at({2, 0, 0}, M_PI);
  ObservedPerson seen = observe(truth, {"head"});
  seen.has_gaze = true;
  seen.gaze_direction = {-1, 0, -0.2};
  const auto fitted = fit_body(seen, nullptr, 1.75);
  EXPECT_LT(off(fitted, truth, "l_shoulder"), 0.05);
  EXPECT_LT(off(fitted, truth, "r_hand"), 0.05);
}

TEST(FitBody, unseen_elbow_bends_by_size_and_unseen_hand_follows_the_forearm) {
  const Person truth = person_at({0, 0, 0}, 0);
  ObservedPerson seen = observe(truth, {"head", "neck", "torso", "l_shoulder", "r_shoulder"});
  const Vector3 shoulder = truth.joints[body_joint_index("r_shoulder")].position;
  const Vector3 wrist = shoulder + Vector3(0.4, 0.05, -0.15);
  seen.joints.push_back({"r_wrist", wrist, 0.8});
  const auto fitted = fit_body(seen, nullptr, 1.75);
  const Vector3 elbow = fitted[body_joint_index("r_elbow")].position,
                hand = fitted[body_joint_index("r_hand")].position;
  const auto bone = [&](const char* a, const char* b) {
    return (truth.joints[body_joint_index(a)].position - truth.joints[body_joint_index(b)].position)
        .norm();
  };
  EXPECT_NEAR((elbow - shoulder).norm(), bone("r_shoulder", "r_elbow"), 0.01);
  EXPECT_NEAR((elbow - wrist).norm(), bone("r_elbow", "r_wrist"), 0.01);
  EXPECT_LT(elbow.z(), std::max(shoulder.z(), wrist.z()));
  EXPECT_NEAR((hand - wrist).normalized().dot((wrist - elbow).normalized()), 1.0, 1e-6);
}

TEST(FitBody, previous_body_keeps_what_is_no_longer_seen) {
  Person previous = person_at({0, 0, 0}, 0);
  const Vector3 elbow = previous.joints[body_joint_index("r_elbow")].position;
  Vector3& wrist = previous.joints[body_joint_index("r_wrist")].position;
  wrist = elbow + (wrist - elbow).norm() * Vector3(0.8, 0, 0.6);
  Person now = previous;
  for (auto& joint : now.joints) joint.position += Vector3(0.1, 0, 0);
  const auto fitted =
      fit_body(observe(now, {"head", "torso", "l_shoulder", "r_shoulder"}), &previous, 1.75);
  EXPECT_LT(off(fitted, now, "r_wrist"), 0.02);
}

TEST(FitBody, nothing_seen_is_nothing_unless_there_was_a_body) {
  EXPECT_TRUE(fit_body({}, nullptr, 1.75).empty());
  const Person previous = person_at({1, 1, 0}, 0);
  EXPECT_LT(off(fit_body({}, &previous, 1.75), previous, "head"), 1e-12);
  ObservedPerson nonsense;
  nonsense.joints.push_back({"head", Vector3::Constant(std::nan("")), 1.0});
  nonsense.joints.push_back({"tail", Vector3::Zero(), 1.0});
  nonsense.joints.push_back({"neck", Vector3::Zero(), 0.0});
  EXPECT_TRUE(fit_body(nonsense, nullptr, 1.75).empty());
}

TEST(FitBody, every_subset_gives_a_finite_body_that_keeps_what_was_seen) {
  constexpr std::uint64_t seed = 3;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, 0.03);
  for (int trial = 0; trial < 500; ++trial) {
    const Person truth = person_at({1, 0.5, 0}, 0.01 * trial, 1.5 + 0.001 * trial);
    ObservedPerson seen;
    for (const auto& joint : truth.joints)
      if (engine() % 3 == 0)
        seen.joints.push_back(
            {joint.name, joint.position + Vector3(noise(engine), noise(engine), noise(engine)),
             0.5});
    const auto fitted = fit_body(seen, trial % 2 == 0 ? nullptr : &truth, truth.stature);
    if (seen.joints.empty()) continue;
    ASSERT_EQ(fitted.size(), kBodyJoints.size());
    for (const auto& joint : fitted)
      EXPECT_TRUE(joint.position.allFinite()) << "trial " << trial << " seed " << seed;
    for (const auto& joint : seen.joints)
      EXPECT_EQ(fitted[body_joint_index(joint.name)].position, joint.position)
          << "trial " << trial << " seed " << seed;
  }
}

TEST(SimplifiedBody, is_a_cylinder_on_the_floor_and_a_head) {
  const auto body = simplified_body(person_at({1, 2, 0}, 0.3));
  EXPECT_NEAR(body.axis_bottom.x(), 1, 0.02);
  EXPECT_NEAR(body.axis_bottom.y(), 2, 0.02);
  EXPECT_NEAR(body.axis_bottom.z(), 0, 0.02);
  EXPECT_NEAR(body.height, 1.49, 0.1);
  EXPECT_NEAR(body.head.z(), 1.63, 0.05);
}

TEST(ComfortableReach, is_before_the_shoulder_and_below_it) {
  const Person p = person_at({0, 0, 0}, M_PI);
  const Vector3 shoulder = p.joints[body_joint_index("r_shoulder")].position,
                reach = comfortable_reach(p, Side::right);
  EXPECT_LT(reach.x(), shoulder.x() - 0.3);
  EXPECT_LT(reach.z(), shoulder.z() - 0.1);
  EXPECT_GT(reach.z(), 0.9);
  EXPECT_GT(reach.y(), comfortable_reach(p, Side::left).y());
}

}  // namespace
TEST(HoldingHand, its_capsule_ends_in_the_palm_and_the_other_stays_stretched) {
  Person anna;
  anna.stature = 1.7;
  anna.joints = standing_body({0, 0, 0}, 0, anna.stature);
  const auto at = [](const Person& who, const char* joint) {
    return who.joints[static_cast<std::size_t>(body_joint_index(joint))].position;
  };
  const auto tip = [](const Person& who, BodyPart hand) {
    for (const BodyCapsule& part : body_capsules(who))
      if (part.part == hand) return part.b;
    return Vector3(Vector3::Zero());
  };
  const Person bent = with_fingers_bent(anna, at(anna, "r_hand") + Vector3(0.05, 0, 0));
  EXPECT_LT((tip(bent, BodyPart::hand_right) - at(anna, "r_hand")).norm(), 1e-9);
  EXPECT_GT((tip(anna, BodyPart::hand_right) - at(anna, "r_hand")).norm(), 0.03)
      << "stretched fingers reach beyond the palm";
  EXPECT_EQ(tip(bent, BodyPart::hand_left), tip(anna, BodyPart::hand_left));
  Person lacking = anna;
  std::erase_if(lacking.joints, [](const BodyJoint& joint) { return joint.name == "r_wrist"; });
  EXPECT_EQ(at(with_fingers_bent(anna, {9, 9, 9}), "head"), at(anna, "head"));
  EXPECT_EQ(with_fingers_bent(lacking, at(anna, "r_hand")).joints.size(), lacking.joints.size());
}

}  // namespace handsel::human_body_test
