#include <gtest/gtest.h>

#include "common/model/human_body.hpp"
#include "components/spark/people_tracker.hpp"
#include "components/spark/scene_model.hpp"

namespace handsel::spark {
namespace {

config::SparkSettings settings() {
  config::SparkSettings s;
  s.set_publish_period(0.1);
  s.set_human_period(0.05);
  s.set_lost_speed(1.6);
  s.set_lost_after(0.2);
  s.set_coverage_memory(0.5);
  s.set_association_distance(0.6);
  s.set_velocity_smoothing(0.06);
  return s;
}

const Coverage kRoom{{-4, -4, -0.5}, {4, 4, 2.6}};
const Coverage kReach{{-1, -1, 0.1}, {1, 1, 1.9}};

ObservedPerson body_at(const std::string& id, double x, double y) {
  ObservedPerson body;
  body.body = id;
  for (const auto& joint : standing_body({x, y, 0}, 0.0, 1.75)) body.joints.push_back({joint.name, joint.position, 1.0});
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

const BodyJoint& torso(const Person& person) { return person.joints[static_cast<std::size_t>(body_joint_index("torso"))]; }

TEST(PeopleTracker, NobodyIsAFactOnlyWhileTheReachIsCovered) {
  PeopleTracker tracker(settings());
  EXPECT_FALSE(tracker.state(at(0), kReach).covered);
  tracker.observe(seen({}), at(0));
  EXPECT_TRUE(tracker.state(at(0.1), kReach).covered);
  EXPECT_FALSE(tracker.state(at(1.0), kReach).covered);
  tracker.observe(seen({}, {{0.5, -4, 0}, {4, 4, 2}}), at(1.0));
  EXPECT_FALSE(tracker.state(at(1.0), kReach).covered);
}

TEST(PeopleTracker, AWalkingPersonHasTheVelocityTheyWalkWith) {
  PeopleTracker tracker(settings());
  for (int i = 0; i <= 60; ++i) tracker.observe(seen({body_at("b", 1.0 + 0.8 * i / 30.0, 0)}), at(i / 30.0));
  const HumanState state = tracker.state(at(2.0), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_NEAR(torso(state.people[0]).velocity.x(), 0.8, 0.02);
}

TEST(PeopleTracker, APersonKeepsTheirNameWhenTheTrackerRenamesTheBody) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0), body_at("bert", -1.5, 0)}), at(0));
  tracker.observe(seen({body_at("7", -1.52, 0), body_at("8", 1.52, 0)}), at(0.03));
  const HumanState state = tracker.state(at(0.03), kReach);
  ASSERT_EQ(state.people.size(), 2u);
  for (const auto& person : state.people) EXPECT_GT(torso(person).position.x() * (person.id == "anna" ? 1 : -1), 1.0);
}

TEST(PeopleTracker, ALostPersonGrowsUntilTheirVolumeIsSeenEmpty) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0)}), at(0));
  const Coverage elsewhere{{-4, -4, -0.5}, {1.0, 4, 2.6}};
  tracker.observe(seen({}, elsewhere), at(0.5));
  HumanState state = tracker.state(at(0.5), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_NEAR(state.people[0].inflation, 0.8, 1e-9);
  tracker.observe(seen({}), at(0.6));
  state = tracker.state(at(0.6), kReach);
  EXPECT_TRUE(state.people.empty());
}

TEST(PeopleTracker, APersonMissedForOneFrameIsStillThereAsTheyWere) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0)}), at(0));
  tracker.observe(seen({}), at(0.033));
  const HumanState state = tracker.state(at(0.05), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_EQ(state.people[0].inflation, 0.0);
}

TEST(PeopleTracker, OneArmOnlyStillMakesACompleteBody) {
  PeopleTracker tracker(settings());
  ObservedPerson whole = body_at("anna", 1.5, 0), part = whole;
  tracker.observe(seen({whole}), at(0));
  std::erase_if(part.joints, [](const ObservedJoint& j) { return j.name[0] != 'r'; });
  for (auto& joint : part.joints) joint.position.x() -= 0.05;
  tracker.observe(seen({part}), at(0.03));
  const HumanState state = tracker.state(at(0.03), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  ASSERT_EQ(state.people[0].joints.size(), kBodyJoints.size());
  for (const auto& joint : state.people[0].joints) EXPECT_TRUE(joint.position.allFinite()) << joint.name;
}

TEST(PeopleTracker, AnObservationFromThePastChangesNothing) {
  PeopleTracker tracker(settings());
  tracker.observe(seen({body_at("anna", 1.5, 0)}), at(1.0));
  tracker.observe(seen({body_at("anna", 1.0, 0)}), at(0.5));
  EXPECT_NEAR(torso(tracker.state(at(1.0), kReach).people[0]).position.x(), 1.5, 0.1);
}

TEST(PeopleTracker, ABodyWithoutJointsIsNobody) {
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

TEST(SceneModel, WhatStandsStillIsKnownBetterThanOneLook) {
  SceneModel model(settings(), std::make_shared<const RobotModel>(), ObjectLibrary{}, {});
  const Vector3 mug(0.7, -0.4, 0.77);
  const Vector3 known = mug_after(model, 60, [&](int i) { return Vector3(mug + 0.0015 * Vector3(i % 2 ? 1 : -1, i % 3 - 1, 0)); });
  EXPECT_LT((known - mug).norm(), 3e-4);
}

TEST(SceneModel, WhatMovesIsTakenAsSeen) {
  SceneModel model(settings(), std::make_shared<const RobotModel>(), ObjectLibrary{}, {});
  const Vector3 known = mug_after(model, 30, [](int i) { return Vector3(0.7 + 0.2 * i / 30.0, -0.4, 0.77); });
  EXPECT_LT((known - Vector3(0.7 + 0.2 * 29 / 30.0, -0.4, 0.77)).norm(), 5e-3);
}

}  // namespace
}  // namespace handsel::spark
