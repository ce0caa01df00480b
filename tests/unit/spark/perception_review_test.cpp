// SPDX-License-Identifier: Apache-2.0
// `handsel doctor --perception`: no finding for correct samples, each fault by its name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "common/model/human/human_body.hpp"
#include "deploy/handsel/doctor/perception_review.hpp"

namespace handsel::perception_review_test {
namespace {

using testing::HasSubstr;

constexpr Stamp kNow = 1'790'000'000'000'000'000;

HumanObservation good(int frame) {
  HumanObservation out;
  out.source = "camera";
  out.coverage = {Vector3(-4, -4, -0.1), Vector3(4, 4, 2.5)};
  ObservedPerson person;
  person.body = "p1";
  for (const BodyJoint& joint : standing_body(Vector3(1.5 + 1e-3 * (frame % 7), 0.2, 0), M_PI, 1.7))
    person.joints.push_back({joint.name, joint.position, 0.9});
  person.has_gaze = true;
  person.gaze_origin = person.joints[0].position;
  person.gaze_direction = -Vector3::UnitX();
  out.people.push_back(person);
  return out;
}

struct Case {
  double rate{30}, age{0.02};
  std::function<void(HumanObservation&, int frame, double& age)> spoil = [](HumanObservation&, int,
                                                                            double&) {};
};

std::vector<Finding> findings(const Case& c) {
  PerceptionReview review(
      {{Vector3(-1.3, -1.3, 0.1), Vector3(1.3, 1.3, 1.9)}, Vector3::Zero(), {"mug"}});
  for (int i = 0; i < static_cast<int>(3 * c.rate); ++i) {
    const double t = i / c.rate;
    HumanObservation m = good(i);
    double age = c.age;
    const Stamp arrival = kNow + static_cast<Stamp>(t * 1e9);
    m.stamp = 1;
    c.spoil(m, i, age);
    if (m.stamp == 1) m.stamp = arrival - static_cast<Stamp>(age * 1e9);
    review.on(m, TimePoint(from_seconds(100 + t)), arrival);
  }
  return review.findings();
}

void expect_only(const std::vector<Finding>& all, const std::string& subject,
                 const std::string& words) {
  int found = 0;
  for (const Finding& finding : all) {
    if (finding.verdict == Verdict::good) continue;
    EXPECT_EQ(finding.subject, subject) << finding.text;
    EXPECT_THAT(finding.text, HasSubstr(words));
    EXPECT_FALSE(finding.remedy.empty());
    ++found;
  }
  EXPECT_EQ(found, 1) << subject << ": one sentence a fault";
}

void expect_fault(const Case& c, const std::string& subject, const std::string& words) {
  SCOPED_TRACE(subject + " " + words);
  expect_only(findings(c), subject, words);
}

void each_joint(HumanObservation& m, const std::function<void(ObservedJoint&)>& act) {
  for (ObservedPerson& person : m.people)
    for (ObservedJoint& joint : person.joints) act(joint);
}

TEST(PerceptionReview, says_nothing_but_good_of_a_good_source) {
  for (const double rate : {15.0, 30.0, 120.0}) {
    const auto all = findings({.rate = rate});
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].verdict, Verdict::good) << all[0].text;
    EXPECT_THAT(all[0].text, HasSubstr("from camera"));
    EXPECT_THAT(all[1].text, HasSubstr("about 1.70 m tall"));
  }
}

TEST(PerceptionReview, names_rates_ages_and_clocks) {
  expect_fault({.rate = 4}, "rate", "4.0 times a second");
  expect_fault({.rate = 500}, "rate", "500 times a second");
  expect_fault({.age = 0.6}, "age", "0.60 s old");
  expect_fault({.age = 30}, "clock offset", "30.000 s in the past");
  expect_fault({.age = -0.4}, "clock offset", "0.400 s in the future");
  expect_fault(
      {.spoil = [](HumanObservation&, int i, double& age) { age += i % 5 == 0 ? 0.15 : 0.0; }},
      "jitter", "varies by 150 ms");
  expect_fault({.spoil = [](HumanObservation& m, int, double&) { m.stamp = 0; }}, "stamp",
               "have no stamp");
  expect_fault(
      {.spoil = [](HumanObservation& m, int i, double&) { m.stamp = kNow / 1'000'000 + 33 * i; }},
      "stamp", "looks like milliseconds");
  expect_fault({.spoil = [](HumanObservation& m, int i,
                            double&) { m.stamp = 40'000'000'000 + 33'000'000 * Stamp{i}; }},
               "stamp", "since something was started");
}

TEST(PerceptionReview, names_frames_and_units) {
  const auto frame = [](const std::function<Vector3(const Vector3&)>& map) {
    return Case{.spoil = [map](HumanObservation& m, int, double&) {
      each_joint(m, [&](ObservedJoint& joint) { joint.position = map(joint.position); });
      m.people[0].has_gaze = false;
      m.coverage = {Vector3(-9999, -9999, -9999), Vector3(9999, 9999, 9999)};
    }};
  };
  expect_fault(frame([](const Vector3& p) { return Vector3(1000 * p); }), "frame", "millimetres");
  expect_fault(frame([](const Vector3& p) { return Vector3(100 * p); }), "frame", "centimetres");
  expect_fault(frame([](const Vector3& p) { return Vector3(-p.y(), 1.4 - p.z(), p.x()); }), "frame",
               "y points down");
  expect_fault(frame([](const Vector3& p) { return Vector3(p.x(), p.z(), -p.y()); }), "frame",
               "y points up");
  expect_fault(frame([](const Vector3& p) { return Vector3(p.x(), -p.y(), -p.z()); }), "frame",
               "z points down");
  expect_fault(frame([](const Vector3& p) { return Vector3(p - Vector3(0, 0, 1.2)); }), "frame",
               "its floor is not that");
  expect_fault(frame([](const Vector3& p) { return Vector3(p + Vector3(40, 0, 0)); }), "reach",
               "out of reach");
}

TEST(PerceptionReview, names_names_ids_and_standstill) {
  expect_fault({.spoil =
                    [](HumanObservation& m, int, double&) {
                      each_joint(m, [](ObservedJoint& j) { j.name = "RIGHT_" + j.name; });
                    }},
               "names", "RIGHT_head");
  expect_fault({.spoil =
                    [](HumanObservation& m, int, double&) {
                      m.people[0].joints.push_back({"nose", m.people[0].joints[0].position, 1});
                    }},
               "names", "nose");
  expect_fault({.spoil = [](HumanObservation& m, int i,
                            double&) { m.people[0].body = "p" + std::to_string(i); }},
               "ids", "90 ids to 1 people");
  expect_fault({.spoil = [](HumanObservation& m, int, double&) { m.people = good(0).people; }},
               "frozen", "the very same body");
  expect_fault({.spoil =
                    [](HumanObservation& m, int i, double&) {
                      m.stamp = kNow + Stamp{i / 4} * 133'333'333;
                      m.people = good(i / 4).people;
                    }},
               "repeated", "once more");
  expect_fault({.spoil =
                    [](HumanObservation& m, int, double&) {
                      each_joint(m, [](ObservedJoint& j) { j.confidence = 0; });
                      m.people[0].has_gaze = false;
                    }},
               "confidence", "below 0.05");
  expect_fault({.spoil = [](HumanObservation& m, int,
                            double&) { m.people[0].gaze_direction = Vector3::UnitX(); }},
               "gaze", "behind themselves");
  EXPECT_EQ(joint_meant("RightWrist"), "r_wrist");
  EXPECT_EQ(joint_meant("LEFT_ELBOW"), "l_elbow");
  EXPECT_EQ(joint_meant("Pelvis"), "waist");
  EXPECT_EQ(joint_meant("rknee"), "r_knee");
  EXPECT_EQ(joint_meant("nose"), "");
}

TEST(PerceptionReview, names_coverage) {
  expect_fault({.spoil = [](HumanObservation& m, int, double&) { m.coverage = {}; }}, "coverage",
               "no volume");
  expect_fault({.spoil =
                    [](HumanObservation& m, int, double&) {
                      m.coverage = {Vector3(0, -4, 0), Vector3(4, 4, 2.5)};
                    }},
               "coverage", "does not contain the robot's reach");
}

TEST(PerceptionReview, names_what_is_malformed_and_what_objects_lack) {
  PerceptionReview review({{Vector3::Zero(), Vector3::Ones()}, Vector3::Zero(), {"mug"}});
  review.on_malformed("handsel/human_observation",
                      "HumanObservation.people[0].joints[3].position.z is not finite");
  review.on_malformed("handsel/human_observation",
                      "HumanObservation.people[0].joints[3].position.z is not finite");
  expect_only(review.findings(), "malformed",
              "2 of 2 samples on handsel/human_observation are malformed and dropped");
  PerceptionReview gaze({{Vector3::Zero(), Vector3::Ones()}, Vector3::Zero(), {"mug"}});
  gaze.on_malformed("handsel/human_observation",
                    "HumanObservation.people[0].gaze_direction has a norm of 2");
  expect_only(gaze.findings(), "gaze", "norm of 2");
  const auto objects = [](const std::string& model, double z) {
    PerceptionReview things({{Vector3::Zero(), Vector3::Ones()}, Vector3::Zero(), {"mug"}});
    for (int i = 0; i < 90; ++i) {
      ObjectObservation m;
      m.source = "tags";
      m.stamp = kNow + Stamp{i} * 33'000'000;
      ObservedObject object;
      object.id = "it";
      object.model = model;
      object.T_world_object.translation().z() = z;
      object.confidence = 1;
      m.objects.push_back(object);
      things.on(m, TimePoint(from_seconds(i * 0.033)), m.stamp + 5'000'000);
    }
    return things.findings();
  };
  ASSERT_EQ(objects("mug", 0.7).size(), 1u);
  EXPECT_EQ(objects("mug", 0.7)[0].verdict, Verdict::good)
      << "an object may stand still to the last bit";
  expect_only(objects("mugg", 0.7), "names", "it (mugg)");
  expect_only(objects("mug", -0.6), "frame", "0.60 m under the floor");
}

}  // namespace
}  // namespace handsel::perception_review_test
