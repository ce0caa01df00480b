// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "common/collision/collision_world.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::collision_world_test {
namespace {

using test::person_at;

Scene scene_with(const std::string& id, const Vector3& center, const Vector3& size) {
  Scene scene;
  scene.boxes.push_back({id, make_pose(center), size, false});
  return scene;
}

class World : public ::testing::Test {
 protected:
  RobotModel robot_{test::planar_arm()};
  CollisionWorld world_{robot_, nullptr};
  Vector q_ = Vector::Zero(3);
};

TEST_F(World, is_free_when_stretched_in_an_empty_scene) { EXPECT_TRUE(world_.check(q_).free); }

TEST_F(World, names_what_touches_what) {
  world_.set_scene(scene_with("table", {1.0, 0, 0}, {0.1, 0.1, 0.1}));
  const CollisionVerdict verdict = world_.check(q_);
  EXPECT_FALSE(verdict.free);
  EXPECT_EQ(verdict.first, "link link3");
  EXPECT_EQ(verdict.second, "box table");
}

TEST_F(World, other_robots_are_obstacles_that_no_distance_to_people_counts) {
  HumanState around;
  around.robots.push_back(
      {"left", {{{1.0, 0, -0.5}, {1.0, 0, 0.5}, 0.05, Vector3::Zero(), Vector3::Zero()}}, 0});
  world_.set_people(around);
  const CollisionVerdict verdict = world_.check(q_);
  EXPECT_FALSE(verdict.free);
  EXPECT_EQ(verdict.second, "robot left");
  EXPECT_EQ(verdict.id, "left");
  EXPECT_TRUE(world_.check_scene(q_).free);
  EXPECT_TRUE(std::isinf(world_.distance_to_people(q_)));
  const Vector away = Vector3(1.5, 0, 0);
  EXPECT_TRUE(world_.check(away).free);
  world_.set_moving_axes({0, 1, 2});
  EXPECT_FALSE(world_.is_free(q_)) << "seen by the wide check too";
  EXPECT_TRUE(world_.is_free(away));
  world_.set_people({});
  EXPECT_TRUE(world_.check(q_).free);
}

TEST_F(World, finds_a_folded_arm_in_self_collision_also_when_asked_again) {
  q_ << 0, 2.9, 2.9;
  EXPECT_FALSE(world_.check(q_).free);
  EXPECT_FALSE(world_.check(q_).free);
  EXPECT_TRUE(world_.check(Vector::Zero(3)).free);
  EXPECT_FALSE(world_.check(q_).free);
}

TEST_F(World, links_that_no_moving_axis_moves_relative_to_each_other_may_touch) {
  q_ << 0, 2.9, 2.9;  // folded: link 1 and link 3 touch
  Vector turned = q_;
  turned[0] = 0.5;
  world_.set_moving_axes({0});
  EXPECT_TRUE(world_.check(q_).free);
  EXPECT_TRUE(world_.is_free(q_));
  EXPECT_TRUE(world_.check_motion(q_, turned).free);
  world_.set_scene(scene_with("table", {0.0, 0.3, 0}, {0.1, 0.1, 0.1}));
  turned[0] = M_PI / 2;
  EXPECT_FALSE(world_.check_motion(q_, turned).free) << "what moves still counts";
  world_.set_scene({});
  world_.set_moving_axes({1});
  EXPECT_FALSE(world_.check(q_).free);
  EXPECT_FALSE(world_.is_free(q_));
  world_.set_moving_axes({0});
  EXPECT_TRUE(world_.check(q_).free);
  world_.set_moving_axes({});
  EXPECT_FALSE(world_.check(q_).free);
}

TEST_F(World, sees_a_thin_wall_between_the_ends_of_a_motion) {
  world_.set_scene(scene_with("wall", {0.6, 0.6, 0}, {0.1, 0.1, 0.5}));
  Vector to = q_;
  to[0] = M_PI / 2;
  EXPECT_TRUE(world_.check(q_).free);
  EXPECT_TRUE(world_.check(to).free);
  EXPECT_FALSE(world_.check_motion(q_, to).free);
}

TEST_F(World, base_pose_moves_the_robot_not_the_scene) {
  world_.set_scene(scene_with("table", {1.0, 0, 0}, {0.1, 0.1, 0.1}));
  world_.set_base(make_pose({0, 0, 1}));
  EXPECT_TRUE(world_.check(q_).free);
}

TEST_F(World, a_person_in_the_way_is_a_collision_and_far_away_is_a_distance) {
  world_.set_base(make_pose({0, 0, 1.2}));
  world_.set_people(person_at({1.1, 0, 0}));
  const CollisionVerdict verdict = world_.check(q_);
  EXPECT_FALSE(verdict.free);
  EXPECT_EQ(verdict.second, "person anna");
  EXPECT_LT(world_.distance_to_people(q_), 0.0);
  world_.set_people(person_at({3.2, 0, 0}));
  EXPECT_TRUE(world_.check(q_).free);
  EXPECT_GT(world_.distance_to_people(q_), 1.4);
  EXPECT_LT(world_.distance_to_people(q_), 2.1);
  world_.set_people({});
  EXPECT_TRUE(std::isinf(world_.distance_to_people(q_)));
}

TEST_F(World, hands_of_the_person_of_an_exchange_are_no_obstacle_the_torso_stays_one) {
  HumanState people = person_at({5, 0, 0});
  for (BodyJoint& joint : people.people[0].joints)
    if (joint.name == "r_hand" || joint.name == "r_wrist")
      joint.position = {1.1, 0, 0};
    else if (joint.name == "r_elbow")
      joint.position = {1.45, 0, 0};
  world_.set_people(people);
  EXPECT_FALSE(world_.check(q_).free);
  world_.set_attachment({}, {"anna"});
  EXPECT_TRUE(world_.check(q_).free);
  world_.set_people(people);
  EXPECT_TRUE(world_.check(q_).free);
  world_.set_attachment({}, {});
  EXPECT_FALSE(world_.check(q_).free);
  world_.set_people(people, PeopleParts::without_forearms_and_hands);
  EXPECT_TRUE(world_.check(q_).free);
  world_.set_base(make_pose({0, 0, 1.2}));
  world_.set_people(person_at({1.1, 0, 0}));
  world_.set_attachment({}, {"anna"});
  EXPECT_FALSE(world_.check(q_).free);
}

TEST_F(World, what_a_person_holds_is_an_obstacle_that_belongs_to_them) {
  Scene scene;
  SceneObject held;
  held.id = "cup";
  held.holder = Holder::human;
  held.holder_id = "anna";
  held.primitive = {PrimitiveKind::box, {0.1, 0.1, 0.1}};
  held.T_world_object = make_pose({1.0, 0, 0});
  scene.objects = {held};
  world_.set_scene(scene);
  const CollisionVerdict verdict = world_.check(q_);
  EXPECT_FALSE(verdict.free);
  EXPECT_EQ(verdict.second, "object cup");
  EXPECT_FALSE(world_.check_people(q_).free);
  EXPECT_TRUE(world_.check_scene(q_).free);
  world_.set_moving_axes({0, 1, 2});
  EXPECT_FALSE(world_.is_free(q_));
  scene.objects[0].holder = Holder::surface;
  world_.set_scene(scene);
  EXPECT_FALSE(world_.check_scene(q_).free);
  EXPECT_TRUE(world_.check_people(q_).free);
  scene.objects[0].holder = Holder::robot;
  world_.set_scene(scene);
  EXPECT_TRUE(world_.check(q_).free);
}

TEST_F(World, clearance_to_the_scene_is_the_gap) {
  world_.set_scene(scene_with("table", {1.5, 0, 0}, {0.1, 0.1, 0.1}));
  EXPECT_NEAR(world_.distance_to_scene(q_), 1.45 - 1.18, 1e-6);
  EXPECT_NEAR(world_.distance_to_scene(q_, 0.1), 0.1, 1e-12);
  Vector3 on_robot, on_scene;
  const double distance = world_.distance_to_scene(q_, 2.0, &on_robot, &on_scene);
  EXPECT_NEAR((on_robot - on_scene).norm(), distance, 1e-9);
  EXPECT_NEAR(on_robot.x(), 1.18, 1e-6);
  EXPECT_NEAR(on_scene.x(), 1.45, 1e-6);
}

TEST_F(World, counts_its_checks) {
  Vector to = q_;
  to[0] = 1.0;
  world_.check_motion(q_, to, 0.1);
  EXPECT_EQ(world_.checks(), 11u);
  EXPECT_EQ(motion_states(q_, to, 0.1), 11);
  EXPECT_EQ(motion_states(q_, q_, 0.1), 1);
}

}  // namespace
}  // namespace handsel::collision_world_test
