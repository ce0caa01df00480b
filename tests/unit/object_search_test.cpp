// SPDX-License-Identifier: Apache-2.0
// Where attention searches for a lost object with the gaze.
#include "components/attention/object_search.hpp"

#include <gtest/gtest.h>

#include <set>

#include "common/config/resources.hpp"
#include "common/model/human/body_index.hpp"
#include "components/attention/attention.hpp"
#include "components/attention/settings.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::attention::object_search_test {
namespace {

const Vector3 kEye(0, 0, 1.3), kPlace(0.7, -0.6, 0.75);

TimePoint at(double seconds) { return TimePoint(from_seconds(100.0 + seconds)); }

class ObjectSearches : public testing::Test {
 protected:
  ObjectSearches() : settings_(load_settings(resource("config/attention.txtpb"))) {
    action_.state = ActionState::running;
    action_.kind = ActionKind::pick;
    action_.object = "mug";
    SceneObject mug;
    mug.id = "mug";
    mug.T_world_object.translation() = kPlace;
    scene_.objects = {mug};
    scene_.boxes = {{"table", make_pose({0.7, -0.6, 0.35}), {0.6, 0.6, 0.7}, true},
                    {"sideboard", make_pose({0.9, 0.6, 0.45}), {0.4, 0.4, 0.9}, true},
                    {"wall", make_pose({2.5, 0, 1}), {0.1, 6, 2}, false}};
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body(Vector3(1.4, 0.2, 0), M_PI, 1.75);
    people_.people = {anna};
  }
  World world() const { return {&people_, nullptr, &action_, nullptr, nullptr, &scene_}; }
  void lose() { scene_.objects[0].age = settings_.motor.lost_after + 0.1; }

  AttentionSettings settings_;
  HumanState people_;
  ActionStatus action_;
  Scene scene_;
};

TEST_F(ObjectSearches, only_an_object_that_the_action_lacks_is_lost) {
  const double after = settings_.motor.lost_after;
  EXPECT_FALSE(is_object_lost(world(), after));
  lose();
  EXPECT_TRUE(is_object_lost(world(), after));
  action_.holding = true;
  EXPECT_FALSE(is_object_lost(world(), after)) << "it is in the hand";
  action_.holding = false;
  action_.state = ActionState::idle;
  EXPECT_FALSE(is_object_lost(world(), after));
  action_.state = ActionState::running;
  scene_.objects.clear();
  EXPECT_TRUE(is_object_lost(world(), after)) << "it left the scene";
}

TEST_F(ObjectSearches, begins_at_the_last_place_and_comes_to_every_surface_and_hand) {
  ObjectSearch search(settings_.motor);
  EXPECT_FALSE(search.target(world(), kEye, at(0)));
  lose();
  const auto first = search.target(world(), kEye, at(0.1));
  ASSERT_TRUE(first);
  EXPECT_LT((*first - kPlace).norm(), 1e-9);
  const auto hands = std::array{people_.people[0].joints[body::l_hand].position,
                                people_.people[0].joints[body::r_hand].position};
  std::set<std::string> found;
  double all_found_at = -1;
  for (double t = 0.1; t < 10; t += 0.1) {
    const auto target = search.target(world(), kEye, at(t));
    ASSERT_TRUE(target);
    for (int k = 0; k < 2; ++k)
      if ((*target - hands[static_cast<std::size_t>(k)]).norm() < 1e-9)
        found.insert("hand " + std::to_string(k));
    for (const SceneBox& box : scene_.boxes) {
      const Vector3 p = box.T_world_box.inverse() * *target;
      if (std::abs(p.z() - box.size.z() / 2) < 1e-9 && std::abs(p.x()) < box.size.x() / 2 &&
          std::abs(p.y()) < box.size.y() / 2)
        found.insert(box.id);
    }
    if (found.size() == 4 && all_found_at < 0) all_found_at = t;
  }
  EXPECT_EQ(found, (std::set<std::string>{"hand 0", "hand 1", "sideboard", "table"}));
  EXPECT_GT(all_found_at, 0);
  EXPECT_LT(all_found_at, 5) << "places near come again before far ones were observed";
}

TEST_F(ObjectSearches, each_place_is_observed_for_the_dwell) {
  ObjectSearch search(settings_.motor);
  search.target(world(), kEye, at(0));
  lose();
  const Vector3 first = *search.target(world(), kEye, at(1));
  EXPECT_EQ(*search.target(world(), kEye, at(1 + 0.9 * settings_.motor.search_dwell)), first);
  EXPECT_NE(*search.target(world(), kEye, at(1 + 1.1 * settings_.motor.search_dwell)), first);
}

TEST_F(ObjectSearches, takes_the_gaze_from_a_person_who_walks) {
  for (BodyJoint& joint : people_.people[0].joints) joint.velocity = Vector3(0, 1.5, 0);
  const auto robot = test::small_robot();
  const Body body(*robot, Vector3(0.4, 0, 0));
  ActiveTrajectory active;
  active.position = active.velocity = active.acceleration = Vector::Zero(robot->dof());
  Attention attention(settings_, body);
  const auto gaze = [&](double from) {
    const World now{&people_, nullptr, &action_, &active, nullptr, &scene_};
    for (int i = 0; i < 100; ++i) attention.step(now, at(from + 0.01 * i));
    return attention.advice().gaze_target;
  };
  EXPECT_LT((gaze(0) - people_.people[0].joints[body::head].position).norm(), 1e-6);
  lose();
  const Vector3 searched = gaze(1);
  EXPECT_GT((searched - people_.people[0].joints[body::head].position).norm(), 0.1);
}

}  // namespace
}  // namespace handsel::attention::object_search_test
