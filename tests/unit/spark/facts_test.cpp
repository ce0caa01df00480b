// SPDX-License-Identifier: Apache-2.0
// Facts: each with geometry that makes it true or false, the hysteresis between, and a real
// handover.
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <random>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"
#include "common/model/arm_reach.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/manipulator.hpp"
#include "components/spark/facts/fact_finder.hpp"
#include "components/spark/people/people_tracker.hpp"
#include "components/spark/scene_model.hpp"
#include "tests/support/recorded_handover.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::spark::facts_test {
namespace {

namespace fs = std::filesystem;

settings::SparkSettings shipped() {
  auto settings =
      settings::read_spark_settings(fs::path(HANDSEL_SOURCE_DIR) / "deploy/config/spark.txtpb");
  return settings;
}

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

const Fact* find(const Facts& facts, FactKind kind, const std::string& subject,
                 const std::string& object = "") {
  for (const Fact& fact : facts.facts)
    if (fact.kind == kind && fact.subject == subject && fact.object == object) return &fact;
  return nullptr;
}

/// One person in front of the robot, a mug, nothing moves.
class FactsTest : public ::testing::Test {
 protected:
  FactsTest()
      : robot_(test::small_robot()),
        finder_(shipped(), robot_, [this](const std::string& name) { return model(name); }) {
    scene_.robot_known = true;
    scene_.robot_position = Vector::Zero(static_cast<Eigen::Index>(robot_->axes().size()));
    anna_.id = "anna";
    anna_.joints = standing_body({2.0, 0, 0}, std::numbers::pi, 1.75);
    mug_ = SceneObject{"mug",           "cube", make_pose({1.0, 0.2, 0.9}), Holder::nobody, "", 0,
                       Vector3::Zero(), {}};
  }

  const ObjectModel* model(const std::string& name) {
    if (models_.count(name)) return &models_[name];
    const double edge = name == "cube" ? 0.08 : name == "crate" ? 0.4 : 0;
    if (edge == 0) return nullptr;
    ObjectModel& m = models_[name];
    for (int i = 0; i < 8; ++i)
      m.mesh.vertices.push_back(0.5 * edge *
                                Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    return &m;
  }

  const Facts& look(double t) {
    scene_.objects = others_;
    scene_.objects.insert(scene_.objects.begin(), mug_);
    people_.people = strangers_;
    people_.people.insert(people_.people.begin(), anna_);
    return facts_ = finder_.find(scene_, people_, at(t));
  }

  BodyJoint& joint(const char* name) {
    return anna_.joints[static_cast<std::size_t>(body_joint_index(name))];
  }
  void gaze_at(const Vector3& p) {
    anna_.gaze_known = true;
    anna_.gaze_origin = joint("head").position;
    anna_.gaze_direction = (p - anna_.gaze_origin).normalized();
  }

  std::shared_ptr<const RobotModel> robot_;
  std::map<std::string, ObjectModel> models_;
  FactFinder finder_;
  Scene scene_;
  HumanState people_;
  Person anna_;
  std::vector<Person> strangers_;
  SceneObject mug_;
  std::vector<SceneObject> others_;
  Facts facts_;
};

TEST_F(FactsTest, every_fact_says_what_it_rests_on) {
  gaze_at(mug_.T_world_object.translation());
  joint("torso").velocity = {-0.5, 0, 0};
  mug_.holder = Holder::surface;
  mug_.holder_id = "table";
  look(0);
  EXPECT_GE(facts_.facts.size(), 6u);
  for (const Fact& fact : facts_.facts) {
    EXPECT_FALSE(fact.evidence.empty()) << name(fact.kind);
    EXPECT_LT(fact.evidence.size(), 120u) << name(fact.kind);
  }
  ASSERT_TRUE(find(facts_, FactKind::on_surface, "mug", "table"));
  ASSERT_TRUE(find(facts_, FactKind::approaching, "anna"));
  EXPECT_NEAR(find(facts_, FactKind::approaching, "anna")->value, 0.5, 0.05);
}

TEST_F(FactsTest, a_limit_crossed_to_and_fro_by_noise_changes_nothing) {
  const double limit = shipped().approach_speed;
  int changes = 0;
  bool before = false;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.08 * limit);
  for (int k = 0; k < 300; ++k) {
    joint("torso").velocity = {-limit * (k < 100   ? 0.6
                                         : k < 200 ? 1.25
                                                   : 0.5) +
                                   noise(random),
                               0, 0};
    const bool now = find(look(0.1 * k), FactKind::approaching, "anna") != nullptr;
    changes += now != before;
    before = now;
  }
  EXPECT_EQ(changes, 2) << "begins once, ends once";
}

TEST_F(FactsTest, what_is_in_beside_and_far_from_what) {
  others_ = {
      {"crate", "crate", make_pose({1.0, 0.2, 0.95}), Holder::nobody, "", 0, Vector3::Zero(), {}}};
  look(0);
  EXPECT_TRUE(find(facts_, FactKind::inside, "mug", "crate"));
  EXPECT_FALSE(find(facts_, FactKind::inside, "crate", "mug"));
  EXPECT_FALSE(find(facts_, FactKind::next_to, "mug", "crate"));
  others_[0].T_world_object = make_pose({1.0 + 0.04 + 0.2 + 0.05, 0.2, 0.95});
  look(1);
  EXPECT_FALSE(find(facts_, FactKind::inside, "mug", "crate"));
  ASSERT_TRUE(find(facts_, FactKind::next_to, "mug", "crate"));
  EXPECT_NEAR(find(facts_, FactKind::next_to, "mug", "crate")->value, 0.05, 1e-9);
  others_[0].T_world_object = make_pose({2.5, 0.2, 0.95});
  EXPECT_FALSE(find(look(2), FactKind::next_to, "mug", "crate"));
}

TEST_F(FactsTest, what_a_person_looks_at_and_could_see) {
  gaze_at(mug_.T_world_object.translation());
  look(0);
  EXPECT_TRUE(find(facts_, FactKind::looking_at, "anna", "mug"));
  EXPECT_TRUE(find(facts_, FactKind::visible_to, "mug", "anna"));
  scene_.boxes = {{"wall", make_pose({1.5, 0.1, 1.2}), {0.05, 2.0, 1.2}, false}};
  EXPECT_FALSE(find(look(1), FactKind::visible_to, "mug", "anna")) << "a wall stands between";
  scene_.boxes.clear();
  gaze_at({4.0, 0, 1.5});
  look(2);
  EXPECT_FALSE(find(facts_, FactKind::looking_at, "anna", "mug"));
  EXPECT_FALSE(find(facts_, FactKind::visible_to, "mug", "anna")) << "behind them";
  anna_.gaze_known = false;
  look(3);
  EXPECT_FALSE(find(facts_, FactKind::looking_at, "anna", "mug")) << "nobody knows where they look";
  EXPECT_TRUE(find(facts_, FactKind::visible_to, "mug", "anna")) << "their front stands in";
}

TEST_F(FactsTest, reaching_is_of_the_hand_and_not_of_the_walking_body) {
  for (BodyJoint& j : anna_.joints) j.velocity = {-0.8, 0.15, -0.1};
  EXPECT_FALSE(find(look(0), FactKind::reaching, "anna", "mug"));
  EXPECT_TRUE(find(facts_, FactKind::moving, "anna"));
  for (BodyJoint& j : anna_.joints) j.velocity.setZero();
  joint("r_hand").velocity =
      0.4 * (mug_.T_world_object.translation() - joint("r_hand").position).normalized();
  look(1);
  ASSERT_TRUE(find(facts_, FactKind::reaching, "anna", "mug"));
  EXPECT_NEAR(find(facts_, FactKind::reaching, "anna", "mug")->value, 0.4, 1e-9);
  joint("r_hand").velocity *= -1;
  EXPECT_TRUE(find(look(1.1), FactKind::withdrawn, "anna", "mug"));
  EXPECT_FALSE(find(look(1.4), FactKind::reaching, "anna", "mug"));
  joint("r_hand").velocity.setZero();
  EXPECT_FALSE(find(look(3), FactKind::withdrawn, "anna", "mug")) << "that is long past";
}

TEST_F(FactsTest, offered_taken_back_and_let_go) {
  mug_.holder = Holder::human;
  mug_.holder_id = "anna";
  mug_.T_world_object.translation() = joint("r_hand").position;
  EXPECT_FALSE(find(look(0), FactKind::offering, "anna", "mug"));
  mug_.velocity = {-0.3, 0, 0};
  EXPECT_TRUE(find(look(0.1), FactKind::offering, "anna", "mug"));
  mug_.velocity.setZero();
  for (double t = 0.2; t < 1.5; t += 0.1)
    EXPECT_TRUE(find(look(t), FactKind::offering, "anna", "mug")) << "held out, still";
  mug_.velocity = {0.3, 0, 0};
  EXPECT_TRUE(find(look(1.6), FactKind::withdrawn, "anna", "mug"));
  EXPECT_FALSE(find(look(1.9), FactKind::offering, "anna", "mug"));
  mug_.velocity.setZero();
  mug_.holder = Holder::nobody;
  mug_.holder_id.clear();
  EXPECT_FALSE(find(look(5), FactKind::released, "mug", "anna")) << "nobody took it";
  mug_.holder = Holder::human;
  mug_.holder_id = "anna";
  look(6);
  mug_.holder = Holder::robot;
  mug_.holder_id.clear();
  look(6.1);
  ASSERT_TRUE(find(facts_, FactKind::released, "mug", "anna"));
  EXPECT_TRUE(find(facts_, FactKind::held_by_robot, "mug"));
  EXPECT_FALSE(find(look(8), FactKind::released, "mug", "anna"));
}

TEST_F(FactsTest, a_hand_held_out_to_what_the_robot_holds_waits_for_it) {
  mug_.holder = Holder::robot;
  mug_.T_world_object.translation() = Vector3(1.25, -0.2, 1.3);
  EXPECT_FALSE(find(look(0), FactKind::waiting_to_receive, "anna", "mug")) << "the arms hang";
  const Vector3 shoulder = joint("r_shoulder").position;
  joint("r_elbow").position = shoulder + Vector3(-0.25, 0, -0.05);
  joint("r_wrist").position = shoulder + Vector3(-0.5, 0, -0.1);
  joint("r_hand").position = shoulder + Vector3(-0.58, 0, -0.1);
  EXPECT_TRUE(find(look(1), FactKind::waiting_to_receive, "anna", "mug"));
  mug_.holder = Holder::surface;
  mug_.holder_id = "table";
  EXPECT_FALSE(find(look(2), FactKind::waiting_to_receive, "anna", "mug")) << "nobody holds it";
}

TEST_F(FactsTest, who_can_reach_what) {
  mug_.T_world_object.translation() = Vector3(1.5, 0, 1.2);
  EXPECT_TRUE(find(look(0), FactKind::reachable_by_human, "mug", "anna"));
  mug_.T_world_object.translation() = Vector3(0.0, 0, 1.2);
  look(1);
  EXPECT_FALSE(find(facts_, FactKind::reachable_by_human, "mug", "anna"));
  mug_.T_world_object.translation() = Vector3(30, 0, 1.2);
  EXPECT_FALSE(find(look(2), FactKind::reachable_by_robot, "mug"));
}

TEST_F(FactsTest, either_arm_of_two_reaches) {
  const auto duo =
      std::make_shared<const RobotModel>(RobotModel::load(resource("robots/duo/duo.txtpb")));
  FactFinder finder(shipped(), duo, [this](const std::string& name) { return model(name); });
  scene_.robot_position = duo->rest_configuration();
  const auto reaches = [&](double y, double t) {
    mug_.T_world_object.translation() = Vector3(0.5, y, 0.9);
    scene_.objects = {mug_};
    people_.people = {anna_};
    return find(finder.find(scene_, people_, at(t)), FactKind::reachable_by_robot, "mug") !=
           nullptr;
  };
  EXPECT_TRUE(reaches(0.65, 1)) << "the left arm";
  EXPECT_TRUE(reaches(-0.65, 2)) << "the right arm";
  EXPECT_FALSE(reaches(1.1, 3));
  EXPECT_FALSE(reaches(-1.1, 4));
}

TEST_F(FactsTest, up_to_the_bound_of_the_reach_nothing_is_out_of_reach) {
  const auto duo =
      std::make_shared<const RobotModel>(RobotModel::load(resource("robots/duo/duo.txtpb")));
  FactFinder finder(shipped(), duo, [this](const std::string& name) { return model(name); });
  scene_.robot_position = duo->rest_configuration();
  const std::vector<Manipulator> hands = hands_of(*duo);
  const ArmReach reach = arm_reach(*duo, hands[0].arm, hands[0].palm);
  const Vector3 p_shoulder =
      scene_.T_world_base * duo->link_pose(duo->rest_configuration(), reach.shoulder).translation();
  // Away from the other arm.
  const Vector3 outward = Vector3(0, p_shoulder.y() < 0 ? -1 : 1, 0);
  double t = 0;
  const auto reaches = [&](double ratio) {
    mug_.T_world_object.translation() = p_shoulder + ratio * reach.length * outward;
    scene_.objects = {mug_};
    people_.people = {anna_};
    return find(finder.find(scene_, people_, at(t += 2)), FactKind::reachable_by_robot, "mug") !=
           nullptr;
  };
  EXPECT_FALSE(reaches(1.1));
  EXPECT_FALSE(reaches(1.01));
  EXPECT_TRUE(reaches(0.98));
  EXPECT_TRUE(reaches(1.01)) << "what was in reach stays so a little beyond";
  EXPECT_FALSE(reaches(1.1));
}

// ---- a real handover between two people (120 Hz, both upper bodies, an object with force sensors)
// ----

TEST(RecordedHandover, each_step_is_found_within_a_fifth_of_a_second_and_once) {
  const std::optional<test::RecordedHandover> found = test::recorded_handover();
  if (!found) GTEST_SKIP() << "the recording is not there: HANDSEL_DATA/motion/kth_handover";
  const test::RecordedHandover& recorded = *found;
  const auto robot = test::small_robot();
  const settings::SparkSettings settings = shipped();
  PeopleTracker tracker(settings);
  SceneModel model(settings, robot, nullptr, {});
  FactFinder finder(settings, robot, nullptr);
  const Coverage room{{-3, -3, -1}, {3, 3, 3}}, reach{{-1, -1, 0}, {1, 1, 2}};

  struct Span {
    double from, to;
  };
  std::map<std::string, std::vector<Span>> spans;  // "kind subject object" -> holding times
  constexpr double kLookEvery = 1 / 30.0;
  double next_look = 0;
  for (std::size_t i = 0; i < recorded.baton.size(); ++i) {
    const double t = static_cast<double>(i) / 120;
    HumanObservation people;
    people.source = "capture";
    people.coverage = room;
    for (const auto& [who, joints] : recorded.bodies) {
      ObservedPerson body;
      body.body = who;
      for (const auto& [joint, frames] : joints)
        body.joints.push_back({joint, test::place(frames[i]), 1.0});
      people.people.push_back(std::move(body));
    }
    tracker.observe(people, at(t));
    ObservedObject baton{"baton", "", Pose::Identity(),
                         1.0,     {}, {PrimitiveKind::box, {0.45, 0.03, 0.03}}};
    const auto& row = recorded.baton[i];
    baton.T_world_object = make_pose(
        test::place(row), Eigen::Quaterniond(row[6], row[3], row[4], row[5]).normalized());
    baton.grips = {
        {baton.T_world_object * Vector3(-0.2, 0, 0), std::max(0.0, -recorded.giver_wrench[i][2])},
        {baton.T_world_object * Vector3(0.2, 0, 0), std::max(0.0, -recorded.taker_wrench[i][2])}};
    model.observe({0, "capture", {baton}}, at(t));
    if (t + 1e-9 < next_look) continue;
    next_look += kLookEvery;
    const HumanState state = tracker.state(at(t), reach);
    ASSERT_EQ(state.people.size(), 2u) << t;
    const Facts facts = finder.find(model.scene(at(t), state), state, at(t));
    for (const Fact& fact : facts.facts) {
      auto& list = spans[std::string(name(fact.kind)) + " " + fact.subject + " " + fact.object];
      if (list.empty() || t - list.back().to > 1.5 * kLookEvery) list.push_back({t, t});
      list.back().to = t;
    }
  }

  // Times [s] as published with the recording and read from its wrenches.
  const auto begins = [&](const std::string& fact, double when) {
    const auto& list = spans[fact];
    const bool once = list.size() == 1;
    EXPECT_TRUE(once) << fact << " held " << list.size() << " times";
    if (!list.empty()) {
      EXPECT_NEAR(list.front().from, when, 0.2) << fact;
      std::printf("%-28s %.2f s (%.2f s)\n", fact.c_str(), list.front().from, when);
    }
  };
  begins("reaching taker baton", 1.98);
  begins("offering giver baton", 2.01);
  begins("held_by_human baton taker", 3.28);
  begins("released baton giver", 3.51);
  EXPECT_TRUE(spans["released baton taker"].empty()) << "the taker lets go of it on a table";
  EXPECT_TRUE(spans["offering taker baton"].empty());
  EXPECT_TRUE(spans["withdrawn giver baton"].empty() && spans["withdrawn taker baton"].empty());
  // The giver puts the baton down and picks it up before: no release, and held again in time.
  ASSERT_EQ(spans["held_by_human baton giver"].size(), 2u);
  EXPECT_NEAR(spans["held_by_human baton giver"][0].to, 0.77, 0.2);
  EXPECT_NEAR(spans["held_by_human baton giver"][1].from, 1.88, 0.2);
  EXPECT_NEAR(spans["held_by_human baton giver"][1].to, 3.51, 0.2);
}

}  // namespace
}  // namespace handsel::spark::facts_test
