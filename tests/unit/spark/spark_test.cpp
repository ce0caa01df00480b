// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "common/model/human/human_body.hpp"
#include "components/spark/people/people_tracker.hpp"
#include "components/spark/scene_model.hpp"

namespace handsel::spark::spark_test {
namespace {

settings::SparkSettings settings() {
  settings::SparkSettings s;
  s.publish_period = 0.1;
  s.human_period = 0.05;
  s.lost_speed = 1.6;
  s.lost_after = 0.2;
  s.coverage_memory = 0.5;
  s.max_view_age = 0.25;
  s.association_distance = 0.35;
  s.joint_noise = 0.01;
  s.gaze_memory = 0.5;
  s.empty_after = 0.5;
  s.doubt_time = 0.5;
  s.edge = 0.5;
  s.unseen_after = 0.5;
  return s;
}

const Coverage kRoom{{-4, -4, -0.5}, {4, 4, 2.6}};
const Coverage kReach{{-1, -1, 0.1}, {1, 1, 1.9}};

ObservedPerson body_at(const std::string& id, double x, double y) {
  ObservedPerson body;
  body.body = id;
  for (const auto& joint : standing_body({x, y, 0}, 0.0, 1.75))
    body.joints.push_back({joint.name, joint.position, 1.0});
  return body;
}

HumanObservation seen(std::vector<ObservedPerson> people, const Coverage& coverage = kRoom) {
  HumanObservation observation;
  observation.source = "camera";
  observation.coverage = coverage;
  observation.people = std::move(people);
  return observation;
}

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

const BodyJoint& torso(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))];
}

TEST(PeopleTracker, nobody_is_a_fact_only_while_the_reach_is_covered) {
  PeopleTracker tracker(settings());
  EXPECT_FALSE(tracker.state(at(0), kReach).covered);
  tracker.observe(seen({}), at(0));
  EXPECT_TRUE(tracker.state(at(0.1), kReach).covered);
  EXPECT_FALSE(tracker.state(at(1.0), kReach).covered);
  tracker.observe(seen({}, {{0.5, -4, 0}, {4, 4, 2}}), at(1.0));
  EXPECT_FALSE(tracker.state(at(1.0), kReach).covered);
}

TEST(PeopleTracker, a_walking_person_has_the_velocity_they_walk_with) {
  PeopleTracker tracker(settings());
  for (int i = 0; i <= 60; ++i)
    tracker.observe(seen({body_at("b", 1.0 + 0.8 * i / 30.0, 0)}), at(i / 30.0));
  const HumanState state = tracker.state(at(2.0), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_NEAR(torso(state.people[0]).velocity.x(), 0.8, 0.02);
}

TEST(PeopleTracker, a_person_keeps_their_name_when_the_tracker_renames_the_body) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0), body_at("bert", -1.5, 0)}), at(0));
  tracker.observe(seen({body_at("7", -1.52, 0), body_at("8", 1.52, 0)}), at(0.03));
  const HumanState state = tracker.state(at(0.03), kReach);
  ASSERT_EQ(state.people.size(), 2u);
  for (const auto& person : state.people)
    EXPECT_GT(torso(person).position.x() * (person.id == "anna" ? 1 : -1), 1.0);
}

TEST(PeopleTracker, a_lost_person_grows_until_their_volume_is_seen_empty) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0)}), at(0));
  const Coverage elsewhere{{-4, -4, -0.5}, {1.0, 4, 2.6}};
  tracker.observe(seen({}, elsewhere), at(0.5));
  HumanState state = tracker.state(at(0.5), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_NEAR(state.people[0].inflation, 0.8, 1e-9);
  tracker.observe(seen({}), at(0.6));
  EXPECT_EQ(tracker.state(at(0.6), kReach).people.size(), 1u) << "one empty look is not enough";
  for (int i = 1; i <= 12; ++i) tracker.observe(seen({}), at(0.6 + 0.05 * i));
  state = tracker.state(at(1.2), kReach);
  EXPECT_TRUE(state.people.empty());
}

TEST(PeopleTracker, a_person_missed_for_one_frame_is_still_there_as_they_were) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0)}), at(0));
  tracker.observe(seen({}), at(0.033));
  const HumanState state = tracker.state(at(0.05), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_EQ(state.people[0].inflation, 0.0);
}

TEST(PeopleTracker, one_arm_only_still_makes_a_complete_body) {
  PeopleTracker tracker(settings());
  ObservedPerson whole = body_at("anna", 1.5, 0), part = whole;
  tracker.observe(seen({whole}), at(0));
  std::erase_if(part.joints, [](const ObservedJoint& j) { return j.name[0] != 'r'; });
  for (auto& joint : part.joints) joint.position.x() -= 0.05;
  tracker.observe(seen({part}), at(0.03));
  const HumanState state = tracker.state(at(0.03), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  ASSERT_EQ(state.people[0].joints.size(), kBodyJoints.size());
  for (const auto& joint : state.people[0].joints)
    EXPECT_TRUE(joint.position.allFinite()) << joint.name;
}

TEST(PeopleTracker, an_observation_from_the_past_changes_nothing) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0)}), at(1.0));
  tracker.observe(seen({body_at("anna", 1.0, 0)}), at(0.5));
  EXPECT_NEAR(torso(tracker.state(at(1.0), kReach).people[0]).position.x(), 1.5, 0.1);
}

/// Observes `people` at 30 Hz from `from` to `to` [s]; samples differ slightly, as of a real
/// sensor.
void look(PeopleTracker& tracker, std::vector<ObservedPerson> people, double from, double to,
          const std::string& source = "camera", const Coverage& coverage = kRoom,
          const Obstacles& obstacles = {}) {
  int n = 0;
  for (double t = from; t <= to + 1e-9; t += 1 / 30.0) {
    HumanObservation observation = seen(people, coverage);
    observation.source = source;
    for (auto& person : observation.people)
      for (auto& joint : person.joints) joint.position.z() += 1e-4 * (n % 2);
    tracker.observe(observation, at(t), obstacles);
    ++n;
  }
}

const Person* named(const HumanState& state, const std::string& id) {
  for (const Person& person : state.people)
    if (person.id == id) return &person;
  return nullptr;
}

/// Returns whether the point lies in the occupied volume of a person.
bool occupied(const HumanState& state, const Vector3& p) {
  for (const Person& person : state.people)
    for (const BodyCapsule& part : body_capsules(person))
      if (contains(SightCapsule{part.a, part.b, part.radius}, p)) return true;
  return false;
}

TEST(PeopleTracker, a_swap_of_names_moves_nobody) {
  PeopleTracker tracker(settings());
  look(tracker, {body_at("anna", 1.5, 0.4), body_at("bert", 1.5, -0.4)}, 0, 1);
  look(tracker, {body_at("bert", 1.5, 0.4), body_at("anna", 1.5, -0.4)}, 1.033, 2);
  const HumanState state = tracker.state(at(2), kReach);
  ASSERT_EQ(state.people.size(), 2u);
  EXPECT_GT(torso(*named(state, "anna")).position.y(), 0.3);
  EXPECT_LT(torso(*named(state, "bert")).position.y(), -0.3);
}

TEST(PeopleTracker, after_a_teleport_both_places_count_until_one_is_seen_empty) {
  PeopleTracker tracker(settings());
  look(tracker, {body_at("anna", 1.2, 0)}, 0, 1);
  look(tracker, {body_at("anna", 1.2, 2.5)}, 1.033, 1.5);
  HumanState state = tracker.state(at(1.5), kReach);
  ASSERT_EQ(state.people.size(), 2u);
  EXPECT_TRUE(occupied(state, {1.2, 0, 1.2}));
  EXPECT_TRUE(occupied(state, {1.2, 2.5, 1.2}));
  EXPECT_GT(named(state, "anna")->inflation, 0.5)
      << "the one no longer seen may have gone anywhere";
  look(tracker, {body_at("anna", 1.2, 2.5)}, 1.533, 2.4);
  state = tracker.state(at(2.4), kReach);
  ASSERT_EQ(state.people.size(), 1u) << "the old place was seen empty";
  EXPECT_EQ(state.people[0].id, "anna") << "and the name goes to where they are";
  EXPECT_NEAR(torso(state.people[0]).position.y(), 2.5, 0.1);
}

TEST(PeopleTracker, a_short_jump_leaves_the_old_place_occupied_for_a_while) {
  PeopleTracker tracker(settings());
  look(tracker, {body_at("anna", 1.2, 0)}, 0, 1);
  look(tracker, {body_at("anna", 1.5, 0)}, 1.033, 1.3);
  HumanState state = tracker.state(at(1.3), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_TRUE(occupied(state, {1.2, 0, 1.2}));
  look(tracker, {body_at("anna", 1.5, 0)}, 1.333, 2.0);
  EXPECT_EQ(tracker.state(at(2.0), kReach).people[0].inflation, 0.0);
}

TEST(PeopleTracker, data_told_again_is_no_news) {
  PeopleTracker tracker(settings());
  look(tracker, {body_at("anna", 1.2, 0)}, 0, 1);
  for (int i = 1; i <= 30; ++i) tracker.observe(seen({body_at("anna", 1.2, 0)}), at(1 + i / 30.0));
  const HumanState state = tracker.state(at(2), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_NEAR(state.people[0].age, 1.0, 0.05);
  EXPECT_NEAR(state.people[0].inflation, 1.6, 0.1);
  EXPECT_FALSE(state.covered);
  EXPECT_NE(tracker.trouble(at(2)).find("source camera repeats itself"), std::string::npos);
}

TEST(PeopleTracker, a_silent_source_is_named) {
  PeopleTracker tracker(settings());
  look(tracker, {body_at("anna", 1.2, 0)}, 0, 1);
  EXPECT_EQ(tracker.trouble(at(1.1)), "");
  EXPECT_EQ(tracker.trouble(at(3)), "source camera is silent for 2.0 s");
}

TEST(PeopleTracker, two_sources_that_see_half_a_body_each_make_one_person) {
  PeopleTracker tracker(settings());
  ObservedPerson left = body_at("7", 1.5, 0), right = body_at("track-b", 1.5, 0);
  std::erase_if(left.joints, [](const ObservedJoint& j) { return j.name[0] == 'r'; });
  std::erase_if(right.joints, [](const ObservedJoint& j) { return j.name[0] != 'r'; });
  for (int i = 0; i < 60; ++i) {
    for (auto* body : {&left, &right})
      for (auto& joint : body->joints) joint.position.x() -= 0.01;
    HumanObservation one = seen({left}), other = seen({right});
    one.source = "a";
    other.source = "b";
    tracker.observe(one, at(i / 30.0));
    tracker.observe(other, at(i / 30.0 + 0.005));
  }
  const HumanState state = tracker.state(at(2), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  for (const char* joint : {"l_wrist", "r_wrist", "head"}) {
    const BodyJoint& j = state.people[0].joints[static_cast<std::size_t>(body_joint_index(joint))];
    EXPECT_NEAR(j.velocity.x(), -0.3, 0.08) << joint;
  }
}

TEST(PeopleTracker, gaze_may_come_from_another_source_and_go_missing_for_a_moment) {
  PeopleTracker tracker(settings());
  ObservedPerson body = body_at("anna", 1.5, 0), eyes;
  eyes.body = "gaze-1";
  eyes.has_gaze = true;
  eyes.gaze_origin = Vector3(1.45, 0, 1.62);
  eyes.gaze_direction = Vector3(-1, 0, 0);
  look(tracker, {body}, 0, 0.5);
  EXPECT_FALSE(tracker.state(at(0.5), kReach).people.at(0).gaze_known);
  look(tracker, {eyes}, 0.51, 0.52, "gaze", {});
  look(tracker, {body}, 0.54, 0.9);
  HumanState state = tracker.state(at(0.9), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_TRUE(state.people[0].gaze_known);
  EXPECT_EQ(state.people[0].gaze_direction, eyes.gaze_direction);
  look(tracker, {body}, 0.93, 1.2);
  EXPECT_FALSE(tracker.state(at(1.2), kReach).people[0].gaze_known);
}

TEST(PeopleTracker, knuckles_tell_how_a_hand_is_turned_until_they_are_unobserved) {
  PeopleTracker tracker(settings());
  ObservedPerson body = body_at("anna", 1.5, 0);
  const auto joint = [&](const char* name) -> Vector3& {
    return std::find_if(body.joints.begin(), body.joints.end(),
                        [&](const ObservedJoint& j) { return j.name == name; })
        ->position;
  };
  // Fingers forward, palms toward each other: the thumbs, beside the index fingers, are above.
  const Vector3 forward(-1, 0, 0), left(0, -1, 0);
  for (const char* side : {"l", "r"}) {
    const std::string name = side;
    const Vector3 p_hand = joint((name + "_hand").c_str());
    joint((name + "_wrist").c_str()) = p_hand - 0.08 * forward;
    body.joints.push_back({name + "_index", p_hand + Vector3(0, 0, 0.03), 0.9});
    body.joints.push_back({name + "_pinky", p_hand - Vector3(0, 0, 0.03), 0.9});
  }
  look(tracker, {body}, 0, 0.3);
  Person anna = tracker.state(at(0.3), kReach).people.at(0);
  ASSERT_EQ(anna.palms.size(), 2u);
  EXPECT_EQ(anna.palms[0].joint, "l_hand");
  EXPECT_GT(anna.palms[0].normal.dot(-left), 0.95) << anna.palms[0].normal.transpose();
  EXPECT_EQ(anna.palms[1].joint, "r_hand");
  EXPECT_GT(anna.palms[1].normal.dot(left), 0.95) << anna.palms[1].normal.transpose();
  EXPECT_EQ(anna.joints.size(), kBodyJoints.size());
  std::erase_if(body.joints, [](const ObservedJoint& j) { return j.name == "l_pinky"; });
  look(tracker, {body}, 0.33, 0.9);
  anna = tracker.state(at(0.9), kReach).people.at(0);
  ASSERT_EQ(anna.palms.size(), 1u);
  EXPECT_EQ(anna.palms[0].joint, "r_hand");
}

TEST(PeopleTracker, eyes_without_a_body_are_somebody) {
  PeopleTracker tracker(settings());
  ObservedPerson eyes;
  eyes.body = "gaze-1";
  eyes.has_gaze = true;
  eyes.gaze_origin = Vector3(1.4, 0, 1.62);
  look(tracker, {eyes}, 0, 0.1, "gaze", {});
  EXPECT_TRUE(occupied(tracker.state(at(0.1), kReach), {1.4, 0, 1.2}));
}

TEST(PeopleTracker, what_the_source_cannot_see_is_not_seen_empty) {
  const Obstacles wall{{}, {{make_pose({0.7, 0, 1.25}), {0.1, 6, 2.5}}}};
  PeopleTracker with_eye(settings(), {{"camera", {0, 0, 1.6}}}), without(settings());
  for (PeopleTracker* tracker : {&with_eye, &without}) {
    look(*tracker, {body_at("anna", 1.4, 0)}, 0, 0.5);
    look(*tracker, {}, 0.533, 1.5, "camera", kRoom, wall);
  }
  EXPECT_EQ(with_eye.state(at(1.5), kReach).people.size(), 1u) << "she stands behind the wall";
  EXPECT_TRUE(without.state(at(1.5), kReach).people.empty());
  look(with_eye, {}, 1.533, 2.2);
  EXPECT_TRUE(with_eye.state(at(2.2), kReach).people.empty())
      << "with the wall gone the place is seen empty";
}

/// Anna walks out of the room along +x at 1 m/s within two seconds.
void walk_out(PeopleTracker& tracker, const std::string& name = "anna") {
  for (int i = 0; i <= 60; ++i)
    tracker.observe(seen({body_at(name, 2.9 + i / 60.0, 0)}), at(i / 30.0));
}

TEST(PeopleTracker, who_leaves_through_the_edge_grows_no_farther_than_the_edge_and_is_not_dropped) {
  PeopleTracker tracker(settings());
  walk_out(tracker);
  look(tracker, {}, 2.033, 60.0);
  const HumanState state = tracker.state(at(60), kReach);
  ASSERT_EQ(state.people.size(), 1u) << "never gone silently";
  EXPECT_LE(state.people[0].inflation, 0.51)
      << "for the source looks on and would see her come back";
  EXPECT_FALSE(occupied(state, {2.9, 0, 1.2}));
  EXPECT_TRUE(state.covered);
  EXPECT_NEAR(tracker.state(at(62), kReach).people[0].inflation, 0.5 + 2 * 1.6, 0.1)
      << "when it no longer looks she may come back";
  look(tracker, {}, 62.0, 63.0);
  EXPECT_LE(tracker.state(at(63), kReach).people[0].inflation, 0.51)
      << "what it looks at again is empty";
}

TEST(PeopleTracker, who_comes_in_through_an_edge_is_the_one_who_left) {
  PeopleTracker tracker(settings());
  walk_out(tracker);
  look(tracker, {}, 2.033, 10.0);
  look(tracker, {body_at("77", -3.8, 1)}, 10.033, 10.5);
  const HumanState state = tracker.state(at(10.5), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_EQ(state.people[0].id, "anna");
  EXPECT_LT(torso(state.people[0]).position.x(), -3);
}

TEST(PeopleTracker, who_appears_in_the_middle_is_not_the_one_who_left) {
  PeopleTracker tracker(settings());
  walk_out(tracker);
  look(tracker, {}, 2.033, 10.0);
  look(tracker, {body_at("77", 0, 1)}, 10.033, 10.5);
  EXPECT_EQ(tracker.state(at(10.5), kReach).people.size(), 2u);
}

TEST(PeopleTracker, an_operator_clears_who_is_lost_and_nobody_else) {
  PeopleTracker tracker(settings());
  walk_out(tracker);
  look(tracker, {body_at("bert", 0, 1)}, 2.033, 3.0);
  EXPECT_EQ(tracker.clear("bert", at(3)), 0u) << "he is seen";
  EXPECT_EQ(tracker.clear("carla", at(3)), 0u);
  ASSERT_EQ(tracker.state(at(3), kReach).people.size(), 2u);
  EXPECT_EQ(tracker.clear("anna", at(3)), 1u);
  EXPECT_EQ(tracker.state(at(3), kReach).people.at(0).id, "bert");
  look(tracker, {body_at("bert", 0, 1), body_at("anna", 3, 0)}, 3.033, 3.1);
  EXPECT_EQ(tracker.state(at(3.1), kReach).people.size(), 2u) << "who is seen after all is there";
  look(tracker, {}, 3.133, 3.4, "camera", {{0.5, -4, -0.5}, {0.6, 4, 2.6}});
  EXPECT_EQ(tracker.clear("", at(3.6)), 2u) << "everybody lost";
}

TEST(PeopleTracker, two_halves_cover_the_whole) {
  PeopleTracker tracker(settings());
  look(tracker, {}, 0, 0.1, "left", {{-4, 0, -0.5}, {4, 4, 2.6}});
  EXPECT_FALSE(tracker.state(at(0.1), kReach).covered);
  look(tracker, {}, 0, 0.1, "right", {{-4, -4, -0.5}, {4, 0, 2.6}});
  EXPECT_TRUE(tracker.state(at(0.1), kReach).covered);
  look(tracker, {}, 0.133, 0.2, "right", {{-4, -4, -0.5}, {4, -0.1, 2.6}});
  EXPECT_FALSE(tracker.state(at(0.2), kReach).covered) << "a slit is left";
}

TEST(PeopleTracker, noisy_hands_at_rest_are_at_rest) {
  PeopleTracker tracker(settings());
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  double squares = 0;
  int n = 0;
  for (int i = 0; i < 300; ++i) {
    ObservedPerson body = body_at("anna", 1.4, 0);
    for (auto& joint : body.joints)
      joint.position += Vector3(noise(random), noise(random), noise(random));
    tracker.observe(seen({body}), at(i / 30.0));
    if (i < 60) continue;
    const HumanState state = tracker.state(at(i / 30.0), kReach);
    const Vector3 v =
        state.people.at(0).joints[static_cast<std::size_t>(body_joint_index("r_hand"))].velocity;
    squares += v.squaredNorm() / 3;
    ++n;
  }
  EXPECT_LT(std::sqrt(squares / n), 0.12) << "reach_speed of the facts";
}

/// A person at rest accelerates at 9 m/s^2 to 1.1 m/s: the velocity is known within three samples,
/// without overshoot.
TEST(PeopleTracker, who_starts_to_walk_is_known_to_within_a_few_looks) {
  constexpr double kStart = 2, kSpeed = 1.1, kAcceleration = 9;
  for (const double deviation : {0.004, 0.01}) {
    SCOPED_TRACE("noise " + std::to_string(deviation));
    std::array<double, 9> mean{};
    constexpr int kRuns = 40;
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      std::mt19937_64 random(seed);
      std::normal_distribution<double> noise(0, deviation);
      PeopleTracker tracker(settings());
      for (int i = 0; i < 70; ++i) {
        const double t = i / 30.0 - kStart, ramp = kSpeed / kAcceleration;
        const double gone = t < 0      ? 0
                            : t < ramp ? 0.5 * kAcceleration * t * t
                                       : kSpeed * (t - ramp / 2);
        ObservedPerson body = body_at("anna", 2.4 - gone, 0);
        for (auto& joint : body.joints)
          joint.position += Vector3(noise(random), noise(random), noise(random));
        tracker.observe(seen({body}), at(i / 30.0));
        const HumanState state = tracker.state(at(i / 30.0), kReach);
        const double v = -torso(state.people.at(0)).velocity.x();
        if (t > 0.01) mean[static_cast<std::size_t>(i - 61)] += v / kRuns;
        if (t <= 0 && i > 30) {
          EXPECT_LT(v, 0.25) << "at rest, seed " << seed;
        }
      }
    }
    EXPECT_GT(mean[2], 0.6) << "0.1 s after the start, when it is 0.9";
    EXPECT_GT(mean[4], 1.0) << "0.17 s after the start";
    EXPECT_LT(*std::max_element(mean.begin(), mean.end()), 1.2 * kSpeed);
  }
}

TEST(PeopleTracker, a_dart_is_known_within_a_few_looks) {
  PeopleTracker tracker(settings());
  look(tracker, {body_at("anna", 1.4, 0)}, 0, 1);
  double clock = 1;
  for (int i = 1; i <= 3; ++i) {
    ObservedPerson body = body_at("anna", 1.4, 0);
    for (auto& joint : body.joints)
      if (joint.name == "r_hand" || joint.name == "r_wrist") joint.position.x() -= 1.5 * i / 30.0;
    tracker.observe(seen({body}), at(clock = 1 + i / 30.0));
  }
  const HumanState state = tracker.state(at(clock), kReach);
  EXPECT_LT(
      state.people.at(0).joints[static_cast<std::size_t>(body_joint_index("r_hand"))].velocity.x(),
      -1.2);
}

/// Any part of a body at 15 Hz with confidences, a gaze from elsewhere or none: a complete body, as
/// tall as it is, near where it is.
TEST(PeopleTracker, any_subset_of_joints_makes_a_body_of_its_own_size) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> noise(0, 0.01);
    const double stature = 1.3 + 0.7 * unit(random), yaw = 6.28 * unit(random);
    PeopleTracker tracker(settings());
    std::vector<double> off;
    for (int i = 0; i < 45; ++i) {
      ObservedPerson body;
      body.body = "7";
      const auto truth = standing_body({1.0 + 0.02 * i, 0.5, 0}, yaw, stature);
      for (const BodyJoint& joint : truth)
        if (unit(random) < 0.5)
          body.joints.push_back(
              {joint.name, joint.position + Vector3(noise(random), noise(random), noise(random)),
               0.2 + 0.8 * unit(random)});
      tracker.observe(seen({body}), at(i / 15.0));
      if (unit(random) < 0.5) {
        ObservedPerson eyes;
        eyes.body = "gaze";
        eyes.has_gaze = true;
        eyes.gaze_origin = truth[0].position;
        HumanObservation gaze = seen({eyes}, {});
        gaze.source = "eyes";
        tracker.observe(gaze, at(i / 15.0 + 0.01));
      }
      const HumanState state = tracker.state(at(i / 15.0 + 0.01), kReach);
      if (i < 10) continue;
      ASSERT_EQ(state.people.size(), 1u) << i;
      ASSERT_EQ(state.people[0].joints.size(), kBodyJoints.size());
      for (std::size_t k = 0; k < truth.size(); ++k) {
        off.push_back((state.people[0].joints[k].position - truth[k].position).norm());
      }
    }
    std::sort(off.begin(), off.end());
    EXPECT_LT(off[off.size() / 2], 0.05) << "joints seen or not";
    EXPECT_LT(off[off.size() * 99 / 100], 0.35);
    EXPECT_LT(off.back(), 0.7) << "no farther than a limb is long";
    EXPECT_NEAR(tracker.state(at(3), kReach).people[0].stature, stature, 0.06);
  }
}

TEST(PeopleTracker, whose_height_is_known_is_that_tall_whatever_is_seen_of_them) {
  settings::SparkSettings known = settings();
  known.people.push_back({.id = "anna", .height = 1.62});
  for (const char* who : {"anna", "ben"}) {
    PeopleTracker tracker(known);
    ObservedPerson body;
    body.body = who;
    for (const BodyJoint& joint : standing_body({1.0, 0.5, 0}, 0.3, 1.85))
      body.joints.push_back({joint.name, joint.position, 1.0});
    for (int i = 0; i < 20; ++i) tracker.observe(seen({body}), at(i / 15.0));
    EXPECT_NEAR(tracker.state(at(1.3), kReach).people.at(0).stature,
                body.body == "anna" ? 1.62 : 1.85, 0.03)
        << who;
  }
}

TEST(PeopleTracker, a_body_without_joints_is_nobody) {
  PeopleTracker tracker(settings());
  ObservedPerson empty;
  empty.body = "ghost";
  tracker.observe(seen({empty}), at(0));
  EXPECT_TRUE(tracker.state(at(0), kReach).people.empty());
}

Vector3 mug_after(SceneModel& model, int looks, const std::function<Vector3(int)>& where) {
  for (int i = 0; i < looks; ++i) {
    ObjectObservation observation;
    observation.source = "camera";
    observation.objects.push_back({"mug", "mug", make_pose(where(i)), 0.9});
    model.observe(observation, at(i / 30.0));
  }
  return model.scene(at(looks / 30.0), HumanState{}).objects.at(0).T_world_object.translation();
}

TEST(SceneModel, what_stands_still_is_known_better_than_one_look) {
  SceneModel model(settings(), std::make_shared<const RobotModel>(), ObjectLibrary{}, {});
  const Vector3 mug(0.7, -0.4, 0.77);
  const Vector3 known = mug_after(model, 60, [&](int i) {
    return Vector3(mug + 0.0015 * Vector3(i % 2 ? 1 : -1, i % 3 - 1, 0));
  });
  EXPECT_LT((known - mug).norm(), 3e-4);
}

TEST(SceneModel, what_moves_is_taken_as_seen) {
  SceneModel model(settings(), std::make_shared<const RobotModel>(), ObjectLibrary{}, {});
  const Vector3 known =
      mug_after(model, 30, [](int i) { return Vector3(0.7 + 0.2 * i / 30.0, -0.4, 0.77); });
  EXPECT_LT((known - Vector3(0.7 + 0.2 * 29 / 30.0, -0.4, 0.77)).norm(), 5e-3);
}

}  // namespace
}  // namespace handsel::spark::spark_test
