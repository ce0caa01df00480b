// SPDX-License-Identifier: Apache-2.0
// Quotas of SPARK: the nearest and most relevant elements are kept, the rest is counted, memory
// does not grow with ever-new names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/config/settings_text.hpp"
#include "common/model/human/human_body.hpp"
#include "components/spark/facts/fact_finder.hpp"
#include "components/spark/people/people_tracker.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/scene_model.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::spark::quotas_test {
namespace {

using ::testing::HasSubstr;

const Coverage kReach{{-1, -1, 0.1}, {1, 1, 1.9}};
const Coverage kRoom{{-30, -30, -0.5}, {30, 30, 2.6}};

settings::SparkSettings shipped() {
  auto settings = settings::read_spark_settings(std::filesystem::path(HANDSEL_SOURCE_DIR) /
                                                "deploy/config/spark.txtpb");
  return settings;
}

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

ObservedPerson body_at(const std::string& id, double x, double y) {
  ObservedPerson body;
  body.body = id;
  for (const auto& joint : standing_body({x, y, 0}, 0.0, 1.75))
    body.joints.push_back({joint.name, joint.position, 1.0});
  return body;
}

HumanObservation seen(std::vector<ObservedPerson> people) {
  return {0, "camera", kRoom, std::move(people)};
}

ObservedObject thing(const std::string& id, const Vector3& where) {
  return {id, "", make_pose(where), 0.9, {}, {PrimitiveKind::box, {0.05, 0.05, 0.05}}};
}

SceneModel model(const settings::SparkSettings& settings, std::vector<SceneBox> boxes = {}) {
  return {settings, std::make_shared<const RobotModel>(), ObjectLibrary{}, std::move(boxes)};
}

bool has(const Scene& scene, const std::string& id) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const SceneObject& o) { return o.id == id; });
}

TEST(Quotas, nobody_left_out_is_nearer_than_anybody_kept) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-12, 12), lost(0, 6);
  for (int round = 0; round < 200; ++round) {
    std::vector<Person> all;
    for (int i = 0; i < 60; ++i) {
      Person person;
      person.id = std::to_string(i);
      person.joints = standing_body({place(random), place(random), 0}, place(random), 1.7);
      person.inflation = i % 3 == 0 ? lost(random) : 0.0;
      all.push_back(std::move(person));
    }
    std::vector<Person> kept = all;
    const LeftOut left_out = keep_nearest(kept, 16, kReach);
    ASSERT_EQ(kept.size(), 16u);
    ASSERT_EQ(left_out.count, 44u);
    double farthest = -1e9, nearest = 1e9;
    for (const Person& person : all) {
      const bool stays =
          std::any_of(kept.begin(), kept.end(), [&](const Person& k) { return k.id == person.id; });
      double distance = 1e9;  // min over the joints, from the vertical axis of the arm
      for (const BodyJoint& joint : person.joints) {
        const Vector3 p = joint.position;
        const double over = std::max(0.0, std::max(p.z() - 1.9, 0.1 - p.z()));
        distance =
            std::min(distance, std::hypot(std::hypot(p.x(), p.y()), over) - person.inflation);
      }
      if (stays) farthest = std::max(farthest, distance);
      if (!stays) nearest = std::min(nearest, distance);
    }
    ASSERT_LE(farthest, nearest + 1e-9) << "round " << round;
    ASSERT_NEAR(left_out.nearest, nearest, 1e-9);
  }
}

TEST(Quotas, of_two_hundred_people_the_nearest_sixteen_are_published_and_the_others_counted) {
  PeopleTracker tracker(shipped());
  std::vector<ObservedPerson> crowd;
  for (int i = 0; i < 200; ++i)
    crowd.push_back(body_at("far" + std::to_string(i), 8 + 0.6 * (i % 20), -6 + 0.6 * (i / 20)));
  crowd.push_back(body_at("anna", 1.5, 0));
  std::uint32_t untracked = 0;
  for (int sample = 0; sample < 5; ++sample) {
    std::vector<ObservedPerson> bodies = crowd;
    for (ObservedPerson& body : bodies) body.joints.front().position.x() += 1e-3 * sample;
    untracked = tracker.observe(seen(bodies), at(0.033 * sample), {}, &kReach);
    tracker.keep_nearest(at(0.033 * sample), kReach);
  }
  EXPECT_EQ(untracked, 201u - 32u);
  LeftOut left_out;
  const HumanState state = tracker.state(at(0.14), kReach, &left_out);
  ASSERT_EQ(state.people.size(), 16u);
  EXPECT_EQ(state.left_out, 16u);
  EXPECT_GT(left_out.nearest, arm_radius(kReach));
  EXPECT_TRUE(std::any_of(state.people.begin(), state.people.end(),
                          [](const Person& p) { return p.id == "anna"; }));
}

TEST(Quotas, a_person_known_before_a_crowd_came_is_followed_and_does_not_turn_into_a_lost_one) {
  PeopleTracker tracker(shipped());
  HumanObservation first = seen({body_at("carl", 12, 0)});
  first.coverage.high = first.coverage.low;  // no place is observed empty
  tracker.observe(first, at(0), {}, &kReach);
  for (int sample = 1; sample < 100; ++sample) {
    HumanObservation all = first;
    all.people[0] = body_at("carl", 12, 1e-3 * sample);
    for (int i = 0; i < 60; ++i)
      all.people.push_back(body_at("near" + std::to_string(i), 3 + 0.8 * (i % 8),
                                   -3 + 0.8 * (i / 8) + 1e-3 * sample));
    tracker.observe(all, at(0.033 * sample), {}, &kReach);
    tracker.keep_nearest(at(0.033 * sample), kReach);
  }
  const HumanState state = tracker.state(at(3.3), kReach);
  ASSERT_EQ(state.people.size(), 16u);
  for (const Person& person : state.people) EXPECT_LT(person.age, 0.1) << person.id;
}

TEST(Quotas, a_lost_person_counts_by_how_far_they_may_have_come) {
  settings::SparkSettings settings = shipped();
  settings.max_people = 1;
  PeopleTracker tracker(settings, {{"camera", {0, 0, 1.6}}});
  Obstacles wall;  // no place behind the wall is observed empty
  wall.boxes.push_back({make_pose({2.5, 0, 1}), {0.2, 40, 4}});
  for (int sample = 0; sample < 75; ++sample) {
    HumanObservation observation = seen({body_at("ben", 3, 0.5 + 1e-3 * sample)});
    if (sample == 0) observation.people.push_back(body_at("anna", 4, -1));
    tracker.observe(observation, at(0.033 * sample), wall);
    if (sample == 0) {
      EXPECT_EQ(tracker.state(at(0.1), kReach).people.at(0).id, "ben");
    }
  }
  const HumanState state = tracker.state(at(2.5), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_EQ(state.people[0].id, "anna") << "4.1 m less 1.6 m/s x 2.5 s";
  EXPECT_GE(state.left_out, 1u);
  EXPECT_FALSE(state.covered);
}

TEST(Quotas, ten_thousand_bodies_over_time_leave_a_bounded_number_of_tracks) {
  PeopleTracker tracker(shipped());
  for (int sample = 0; sample < 500; ++sample) {
    std::vector<ObservedPerson> bodies;
    for (int i = 0; i < 20; ++i) {
      const int n = 20 * sample + i;
      bodies.push_back(
          body_at("body" + std::to_string(n), -20 + 0.37 * (n % 107), -20 + 0.41 * (n % 97)));
    }
    HumanObservation observation = seen(std::move(bodies));
    observation.source = "camera" + std::to_string(sample % 50);
    observation.coverage.high = observation.coverage.low;
    tracker.observe(observation, at(0.05 * sample), {}, &kReach);
    tracker.keep_nearest(at(0.05 * sample), kReach);
  }
  const HumanState state = tracker.state(at(25), kReach);
  EXPECT_EQ(state.people.size() + state.left_out, 64u);
}

TEST(Quotas, a_new_source_takes_the_place_of_a_silent_one_only) {
  settings::SparkSettings settings = shipped();
  settings.max_sources = 2;
  PeopleTracker tracker(settings);
  const auto observe = [&](const std::string& source, double t) {
    HumanObservation observation = seen({body_at("anna", 2 + 1e-3 * t, 0)});
    observation.source = source;
    tracker.observe(observation, at(t));
  };
  observe("left", 0);
  observe("right", 0.1);
  observe("stranger", 0.2);
  EXPECT_EQ(tracker.refused_observations(), 1u);
  for (int i = 1; i < 20; ++i) observe("right", 0.1 + 0.1 * i);
  observe("stranger", 2.1);
  EXPECT_EQ(tracker.refused_observations(), 1u);
  EXPECT_EQ(tracker.trouble(at(2.1)), "") << "the silent source is forgotten";
}

TEST(Quotas, what_is_held_or_wanted_stays_in_the_scene_before_what_is_near) {
  SceneModel scene = model(shipped());
  HumanState people;
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body({6, 0, 0}, 0, 1.75);
  people.people.push_back(anna);
  const Vector3 hand = anna.joints[static_cast<std::size_t>(body_joint_index("r_hand"))].position;
  scene.request("wanted");
  std::vector<ObservedObject> things{thing("in_hand", hand), thing("wanted", {9, 9, 1}),
                                     thing("near", {0.4, 0, 1})};
  for (int i = 0; i < 1000; ++i)
    things.push_back(
        thing("clutter" + std::to_string(i), {1.5 + 0.05 * (i % 40), 0.1 * (i / 40), 1}));
  scene.observe({0, "camera", {things.begin(), things.begin() + 3}}, at(0));
  scene.scene(at(0), people);
  scene.observe({0, "camera", things}, at(0.03));
  const Scene out = scene.scene(at(0.03), people);
  ASSERT_EQ(out.objects.size(), 64u);
  EXPECT_TRUE(has(out, "in_hand"));
  EXPECT_TRUE(has(out, "wanted"));
  EXPECT_TRUE(has(out, "near"));
  EXPECT_EQ(out.left_out, 64u) << "128 are remembered";
  EXPECT_EQ(scene.forgotten(), 1003u - 128u);
  double farthest = 0;
  for (const SceneObject& object : out.objects)
    if (object.id.starts_with("clutter"))
      farthest = std::max(farthest, object.T_world_object.translation().head<2>().norm());
  std::size_t nearer = 0;
  for (const ObservedObject& object : things)
    if (object.id.starts_with("clutter"))
      nearer += object.T_world_object.translation().head<2>().norm() < farthest - 1e-9;
  EXPECT_LT(nearer, 64u) << "only the nearest were kept";
}

TEST(Quotas, objects_left_out_within_reach_degrade_spark) {
  SceneModel scene = model(shipped());
  std::vector<ObservedObject> things;
  for (int i = 0; i < 100; ++i)
    things.push_back(thing("cup" + std::to_string(i), {0.3 + 0.003 * i, 0, 1}));
  scene.observe({0, "camera", things}, at(0));
  scene.scene(at(0), {});
  EXPECT_THAT(scene.trouble(at(0)), HasSubstr("36 objects are left out of the scene"));
  EXPECT_THAT(scene.trouble(at(0)), HasSubstr("within its reach"));
}

TEST(Quotas, of_three_hundred_boxes_the_nearest_are_published) {
  std::vector<SceneBox> boxes;
  for (int i = 0; i < 300; ++i)
    boxes.push_back(
        {"box" + std::to_string(i), make_pose({0.1 * (300 - i), 0, 0.5}), {0.05, 0.05, 1}, false});
  SceneModel scene = model(shipped(), boxes);
  const Scene out = scene.scene(at(0), {});
  ASSERT_EQ(out.boxes.size(), 64u);
  EXPECT_EQ(out.left_out, 236u);
  for (const SceneBox& box : out.boxes)
    EXPECT_LE(box.T_world_box.translation().x(), 6.4 + 1e-9) << box.id;
  EXPECT_EQ(out.boxes.back().id, "box299");
}

TEST(Quotas, facts_of_safety_and_exchange_stay_when_there_are_too_many) {
  const settings::SparkSettings settings = shipped();
  const auto robot = test::small_robot();
  FactFinder finder(settings, robot, ObjectLibrary{});
  Scene scene;
  scene.robot_known = true;
  scene.robot_position = Vector::Zero(static_cast<Eigen::Index>(robot->axes().size()));
  HumanState people;
  for (int i = 0; i < 16; ++i) {
    Person person;
    person.id = "person" + std::to_string(i);
    person.joints = standing_body({0.9 + 0.15 * i, 0, 0}, std::numbers::pi, 1.75);
    people.people.push_back(std::move(person));
  }
  for (int i = 0; i < 64; ++i) {
    SceneObject object;
    object.id = "cup" + std::to_string(i);
    object.T_world_object = make_pose({0.6 + 0.01 * i, 0.2, 0.9});
    object.primitive = {PrimitiveKind::box, {0.05, 0.05, 0.05}};
    if (i == 63) object.holder = Holder::human, object.holder_id = "person15";
    scene.objects.push_back(object);
  }
  const Facts facts = finder.find(scene, people, at(0));
  ASSERT_EQ(facts.facts.size(), 256u);
  EXPECT_GT(facts.left_out, 0u);
  int zones = 0, held = 0;
  for (const Fact& fact : facts.facts) {
    zones += fact.kind >= FactKind::in_contact_zone && fact.kind <= FactKind::in_social_zone;
    held += fact.kind == FactKind::held_by_human && fact.subject == "cup63";
  }
  EXPECT_EQ(zones, 16) << "one for each person";
  EXPECT_EQ(held, 1);
}

TEST(Quotas, a_quota_out_of_range_is_refused_with_file_line_and_key) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "spark.txtpb";
  const auto refusal = [&](const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      SettingsText read;
      const auto settings = settings::read_spark_settings(file, &read);
      check_quotas(settings, read);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("memory: 1\nmax_people: 17\n"),
            file.string() + ":2:max_people: is 17, must be a number in [1, 16]");
  EXPECT_EQ(refusal("max_objects: 0\n"),
            file.string() + ":1:max_objects: is 0, must be a number in [1, 64]");
  EXPECT_THAT(refusal("max_bodies: 16\n"),
              HasSubstr(":1:max_bodies: is 16, must be above max_people and at most max_tracks"));
  EXPECT_THAT(refusal("max_objects: 64\nmax_known_objects: 32\n"),
              HasSubstr(":1:max_objects: is 64, must be at most max_known_objects"));
  EXPECT_EQ(refusal("max_people: 16\n"), "");
}

}  // namespace
}  // namespace handsel::spark::quotas_test
