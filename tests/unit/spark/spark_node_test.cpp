// SPDX-License-Identifier: Apache-2.0
// SPARK on a LocalBus: inputs from sources and operators, and outputs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/errors.hpp"
#include "common/bus/local_bus.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "components/spark/node.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::spark_node_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

class SparkNode : public ::testing::Test {
 protected:
  SparkNode() : network_(3) {
    setenv("HANDSEL_HOME", (std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy").c_str(), 1);
    context_.robot = test::small_robot();
    context_.settings = folder_.path();
    std::filesystem::copy(std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/config/spark.txtpb",
                          folder_.path());
  }
  void start() {
    node_ = std::make_unique<spark::Node>(network_.add("spark"), context_);
    Bus& others = network_.add("sim");
    things_out_ = others.advertise<ObjectObservation>();
    people_out_ = others.advertise<HumanObservation>();
    goals_out_ = network_.add("handsel").advertise<TaskGoal>();
    Bus& reader = network_.add("supervisor");
    safety_out_ = reader.advertise<SafetyState>();
    reader.subscribe<Scene>(
        [this](const Scene& scene, const Receipt&) { scene_ = scene, ++scenes_; });
    reader.subscribe<HumanState>(
        [this](const HumanState& people, const Receipt&) { people_ = people; });
    reader.subscribe<ComponentHealth>([this](const ComponentHealth& health, const Receipt&) {
      if (health.component == "spark") health_ = health;
    });
    network_.run_for(milliseconds(200));
  }
  void see_person(const Vector3& feet, int looks, const std::string& source = "camera") {
    for (int i = 0; i < looks; ++i) {
      HumanObservation observation;
      observation.source = source;
      observation.coverage = {{-1, -1, -1}, {1, 1, 1}};
      observation.people.push_back({"anna", {}, false});
      for (const BodyJoint& joint : standing_body(feet + Vector3(0, 0, 1e-4 * (i % 2)), 0, 1.7))
        observation.people[0].joints.push_back({joint.name, joint.position, 1});
      people_out_->publish(observation);
      network_.run_for(milliseconds(33));
    }
  }

  test::TemporaryFolder folder_;
  LocalNetwork network_;
  NodeContext context_;
  std::unique_ptr<spark::Node> node_;
  std::unique_ptr<Publisher<ObjectObservation>> things_out_;
  std::unique_ptr<Publisher<HumanObservation>> people_out_;
  std::unique_ptr<Publisher<TaskGoal>> goals_out_;
  std::unique_ptr<Publisher<SafetyState>> safety_out_;
  Scene scene_;
  HumanState people_;
  ComponentHealth health_;
  int scenes_{0};
};

TEST_F(SparkNode, an_operator_clears_a_lost_person_and_nobody_who_is_seen) {
  start();
  see_person({2.5, 0, 0}, 10);
  TaskGoal clear;
  clear.id = 1;
  clear.kind = TaskKind::clear_person;
  clear.human = "anna";
  goals_out_->publish(clear);
  network_.run_for(milliseconds(20));
  ASSERT_EQ(people_.people.size(), 1u) << "she is seen";
  EXPECT_EQ(people_.people[0].hands.size(), 2u);
  network_.run_for(milliseconds(2000));
  ASSERT_EQ(people_.people.size(), 1u) << "never gone by itself";
  EXPECT_GT(people_.people[0].inflation, 2.5);
  EXPECT_TRUE(people_.people[0].hands.empty());
  clear.id = 2;
  goals_out_->publish(clear);
  network_.run_for(milliseconds(20));
  EXPECT_TRUE(people_.people.empty());
}

TEST_F(SparkNode, nobody_is_a_fact_only_once_it_is_known_who_was_lost_before) {
  start();
  for (int i = 0; i < 10; ++i) {
    HumanObservation nobody;
    nobody.source = "camera";
    nobody.coverage = {{-5, -5, -1}, {5, 5, 3}};
    people_out_->publish(nobody);
    network_.run_for(milliseconds(33));
  }
  EXPECT_FALSE(people_.covered) << "somebody may have been lost before this process began";
  SafetyState safety;
  safety.revision = 1;
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body({2.5, 0, 0}, 0, 1.7);
  anna.age = 30;
  safety.lost.push_back(anna);
  safety_out_->publish(safety);
  network_.run_for(milliseconds(100));
  EXPECT_TRUE(people_.covered);
  ASSERT_EQ(people_.people.size(), 1u);
  EXPECT_EQ(people_.people[0].id, "anna");
  EXPECT_GT(people_.people[0].inflation, 1.6 * 30);
}

TEST_F(SparkNode, a_source_that_is_always_late_is_not_live_and_its_people_are_as_old) {
  start();
  const Bus& clock = network_.add("clock");
  for (int i = 0; i < 15; ++i) {
    HumanObservation late;
    late.source = "camera";
    late.coverage = {{-5, -5, -1}, {5, 5, 3}};
    late.stamp = clock.stamp_now() - std::chrono::nanoseconds(milliseconds(500)).count();
    late.people.push_back({"anna", {}, false});
    for (const BodyJoint& joint : standing_body(Vector3(2.5, 0, 1e-4 * (i % 2)), 0, 1.7))
      late.people[0].joints.push_back({joint.name, joint.position, 1});
    people_out_->publish(late);
    network_.run_for(milliseconds(33));
  }
  ASSERT_EQ(people_.views.size(), 1u);
  EXPECT_FALSE(people_.views[0].live);
  EXPECT_THAT(people_.views[0].reason, HasSubstr("is late: its pictures are 0.50 s old"));
  ASSERT_EQ(people_.people.size(), 1u);
  EXPECT_GE(people_.people[0].age, 0.5);
  network_.run_for(milliseconds(300));
  EXPECT_EQ(health_.state, HealthState::degraded);
  EXPECT_THAT(health_.reason, HasSubstr("source camera is"));
}

TEST_F(SparkNode, a_camera_that_speaks_in_its_own_frame_is_brought_to_the_world) {
  folder_.write("calibration.txtpb",
                R"(sources { source: "side" speaks_in: CAMERA
        T_world_camera { position { x: 1 y: 2 z: 0.1 } } })");
  start();
  see_person({1, 0, 0}, 5, "side");
  ASSERT_EQ(people_.people.size(), 1u);
  EXPECT_NEAR(people_.people[0].joints[0].position.x(), 2, 0.05);
  EXPECT_NEAR(people_.people[0].joints[0].position.y(), 2, 0.05);
}

TEST_F(SparkNode, does_not_start_with_a_calibration_that_is_wrong) {
  folder_.write(
      "calibration.txtpb",
      R"(sources { source: "side" speaks_in: CAMERA T_world_camera { orientation { x: 2 } } })");
  EXPECT_THROW(start(), ConfigError);
}

TEST_F(SparkNode, news_of_things_come_at_once_and_refusals_are_told) {
  start();
  const int now = scenes_;
  network_.run_until([&] { return scenes_ > now; }, network_.now() + milliseconds(500));
  const int before = scenes_;
  ObjectObservation things;
  things.source = "tracker";
  things.objects = {
      {"crate", "", make_pose({0.6, 0, 0.8}), 0.9, {}, {PrimitiveKind::box, {0.2, 0.3, 0.2}}},
      {"fog", "", make_pose({0.6, 0, 0.8}), 0.9, {}, {}}};
  things_out_->publish(things);
  network_.run_for(milliseconds(2));
  EXPECT_EQ(scenes_, before + 1) << "not at the period";
  ASSERT_EQ(scene_.objects.size(), 1u);
  EXPECT_EQ(scene_.objects[0].primitive.size, Vector3(0.2, 0.3, 0.2));
  network_.run_for(milliseconds(300));
  EXPECT_THAT(health_.reason, HasSubstr("object fog of source tracker has neither a model nor a "
                                        "primitive with a size above 0: refused, 1 so far"));
}

}  // namespace
}  // namespace handsel::spark_node_test
