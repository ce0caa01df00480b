// SPDX-License-Identifier: Apache-2.0
// How often attention requests that sensors measure what.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/model/human/body_index.hpp"
#include "components/attention/attention.hpp"
#include "components/attention/settings.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::attention::sensor_request_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SensorRequests : public testing::Test {
 protected:
  SensorRequests()
      : settings_(load_settings(resource("config/attention.txtpb"))),
        robot_(test::small_robot()),
        body_(*robot_, Vector3(0.4, 0, 0)) {
    active_.position = Vector::Zero(robot_->dof());
    active_.velocity = active_.acceleration = active_.position;
  }
  void person_at(double x) {
    Person p;
    p.id = "anna";
    p.joints = standing_body(Vector3(x, 0, 0), M_PI, 1.75);
    people_.people = {p};
  }
  void act(ActionKind kind, const std::string& human = "") {
    action_.state = ActionState::running;
    action_.kind = kind;
    action_.object = "mug";
    action_.human = human;
  }
  void object_at(const Vector3& p_world) {
    SceneObject mug;
    mug.id = "mug";
    mug.T_world_object.translation() = p_world;
    scene_.objects = {mug};
  }
  /// Returns the request after two seconds of this situation.
  SensorRequest request() {
    Attention attention(settings_, body_);
    const World world{&people_, nullptr, &action_, &active_, nullptr, &scene_};
    for (int k = 0; k < 200; ++k) attention.step(world, TimePoint(from_seconds(100.0 + 0.01 * k)));
    return attention.sensor_request(world);
  }

  AttentionSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  Body body_;
  HumanState people_;
  ActionStatus action_;
  ActiveTrajectory active_;
  Scene scene_;
};

TEST_F(SensorRequests, few_samples_suffice_while_nobody_is_near) {
  person_at(6.0);
  const SensorRequest far = request();
  EXPECT_LT(far.people_rate, 15);
  EXPECT_LT(far.objects_rate, 12);
  EXPECT_FALSE(far.hands);
  EXPECT_EQ(far.region_rate, 0);
  EXPECT_TRUE(far.source.empty()) << "every source is asked";

  person_at(0.9);
  const SensorRequest near = request();
  EXPECT_GT(near.people_rate, 29);
  EXPECT_GT(near.objects_rate, 29) << "a person near can move objects";
}

TEST_F(SensorRequests, never_asks_for_less_than_the_guard_needs) {
  for (const double x : {0.5, 1.0, 2.0, 4.0, 9.0}) {
    person_at(x);
    const SensorRequest now = request();
    EXPECT_GE(now.people_rate, 1 / settings_.max_sensed_period) << x;
    EXPECT_GE(now.objects_rate, 1 / settings_.max_sensed_period) << x;
  }
}

TEST_F(SensorRequests, the_object_of_the_action_is_measured_more_often_than_the_others) {
  person_at(6.0);
  const Vector3 p_hand = body_.grasp_point(active_.position, Pose::Identity());
  act(ActionKind::pick);
  object_at(p_hand + Vector3(0.05, 0, 0));
  const SensorRequest close = request();
  EXPECT_THAT(close.objects, ElementsAre("mug"));
  EXPECT_GT(close.region_rate, 25);
  EXPECT_LT(close.objects_rate, 12);
  EXPECT_LT(((close.region.low + close.region.high) / 2 - p_hand).norm(), 1e-9);
  EXPECT_NEAR((close.region.high - close.region.low).x(), 2 * settings_.region_size, 1e-9);

  object_at(p_hand + Vector3(2.0, 0, 0));
  EXPECT_LT(request().region_rate, close.region_rate) << "the hand is still far away";
}

TEST_F(SensorRequests, a_lost_object_is_searched_for_at_full_rate) {
  person_at(6.0);
  act(ActionKind::pick);
  const SensorRequest lost = request();
  EXPECT_EQ(lost.objects_rate, 0) << "own rate of the sensor";
  EXPECT_TRUE(lost.objects.empty());
  object_at(Vector3(1, 0, 1));
  EXPECT_GT(request().objects_rate, 0);
  scene_.objects[0].age = 2 * settings_.motor.lost_after;
  EXPECT_EQ(request().objects_rate, 0) << "unseen for too long";
}

TEST_F(SensorRequests, knuckles_are_wanted_for_an_exchange) {
  person_at(6.0);
  object_at(Vector3(1, 0, 1));
  act(ActionKind::pick);
  EXPECT_FALSE(request().hands);
  act(ActionKind::pick, "anna");
  EXPECT_TRUE(request().hands) << "what is picked is for a person";
}

TEST_F(SensorRequests, without_attention_everything_is_measured) {
  settings_.off = true;
  person_at(6.0);
  const SensorRequest request = this->request();
  EXPECT_EQ(request.people_rate, 0);
  EXPECT_EQ(request.objects_rate, 0);
  EXPECT_TRUE(request.hands);
}

TEST(SensorRequestSettings, a_period_longer_than_the_guard_allows_is_refused_with_its_line) {
  std::ifstream in(resource("config/attention.txtpb"));
  const std::string shipped((std::istreambuf_iterator<char>(in)), {});
  for (const std::string work : {"sensed_people", "sensed_objects"}) {
    std::string edited = shipped;
    const std::size_t at = edited.find("\"" + work + "\"");
    const std::size_t from = edited.find("p_max: ", at) + 7;
    edited.replace(from, edited.find(' ', from) - from, "0.5");
    const test::TemporaryFolder folder;
    const std::string file = folder.write("attention.txtpb", edited);
    const auto line = std::to_string(
        1 + std::count(shipped.begin(), shipped.begin() + static_cast<long>(at), '\n'));
    EXPECT_THAT(test::message_of<ConfigError>([&] { load_settings(file); }),
                HasSubstr("attention.txtpb:" + line + ":p_max: the guard needs a period of " +
                          work + " of at most max_sensed_period"));
  }
}

}  // namespace
}  // namespace handsel::attention::sensor_request_test
