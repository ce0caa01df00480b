// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "common/cost/human_cost.hpp"
#include "components/costmap/layers.hpp"

namespace handsel::costmap::costmap_test {
namespace {

Person standing(const Vector3& feet, double yaw) {
  Person person;
  person.id = "anna";
  person.joints = standing_body(feet, yaw, 1.75);
  return person;
}

std::uint8_t value_at(const Costmap& map, const Vector3& p) {
  const Eigen::Vector3i cell = ((p - map.origin) / map.resolution).array().round().cast<int>();
  return map.values[(static_cast<std::size_t>(cell.z()) * map.ny + cell.y()) * map.nx + cell.x()];
}

/// One maker for all: the volume of an arm is computed once.
Costmap comfort_of(const Person& person, const std::vector<SceneBox>& boxes) {
  static MapMaker maker({});
  return maker.make(person, boxes)[2];
}

TEST(Layers, are_four_over_one_grid_of_two_meters_around_the_shoulders) {
  MapMaker maker({});
  const Layers& layers = maker.make(standing({1, 0.5, 0}, 0.7), {});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    EXPECT_EQ(layers[i].layer, kOwnLayers[i]);
    EXPECT_EQ(layers[i].person, "anna");
    EXPECT_EQ(layers[i].origin, layers[0].origin);
    EXPECT_NEAR(layers[i].resolution * (layers[i].nx - 1), 2.0, 1e-12);
    ASSERT_EQ(layers[i].values.size(), std::size_t{81} * 81 * 81);
  }
  const Vector3 middle = layers[0].origin + Vector3::Constant(1.0);
  EXPECT_LT((middle - Vector3(1, 0.5, 1.4)).norm(), 0.1);
}

TEST(Layers, a_person_without_arms_or_head_gets_a_map_all_the_same) {
  Person person;
  person.id = "torso";
  for (const BodyJoint& joint : standing_body({0, 0, 0}, 0, 1.75))
    if (joint.name == "waist" || joint.name == "torso") person.joints.push_back(joint);
  MapMaker maker({});
  const Layers& layers = maker.make(person, {});
  EXPECT_TRUE(std::all_of(layers[2].values.begin(), layers[2].values.end(),
                          [](std::uint8_t v) { return v == 255; }));
  EXPECT_TRUE(std::all_of(layers[1].values.begin(), layers[1].values.end(),
                          [](std::uint8_t v) { return v == 0; }));
}

TEST(ComfortMap, a_comfortable_point_is_better_than_a_stretched_one) {
  const Costmap map = comfort_of(standing({0, 0, 0}, 0), {});
  EXPECT_LT(value_at(map, {0.35, -0.2, 1.1}), value_at(map, {0.1, -0.25, 1.9}));
  EXPECT_EQ(value_at(map, {-0.6, 0, 1.1}), 255) << "behind the back";
}

TEST(ComfortMap, under_inside_and_near_a_table_is_no_place) {
  const Person person = standing({0, 0, 0}, 0);
  const std::vector<SceneBox> table = {{"table", make_pose({0.6, 0, 1.0}), {0.7, 1.2, 0.04}, true}};
  const Costmap free = comfort_of(person, {}), map = comfort_of(person, table);
  for (const Vector3& p :
       {Vector3(0.3, -0.25, 0.95), Vector3(0.3, -0.25, 1.0), Vector3(0.3, -0.25, 1.05)}) {
    EXPECT_LT(value_at(free, p), 255);
    EXPECT_EQ(value_at(map, p), 255);
  }
  EXPECT_LT(value_at(free, {0.3, -0.25, 1.25}), 255);
  EXPECT_EQ(value_at(map, {0.3, -0.25, 1.25}), value_at(free, {0.3, -0.25, 1.25}));
}

TEST(ComfortMap, behind_a_wall_is_no_place_and_a_shelf_overhead_does_no_harm) {
  const Person person = standing({0, 0, 0}, 0);
  const Costmap wall =
      comfort_of(person, {{"wall", make_pose({0.3, 0, 1.25}), {0.05, 4, 2.5}, false}});
  EXPECT_EQ(value_at(wall, {0.5, -0.2, 1.2}), 255);
  EXPECT_LT(value_at(wall, {0.2, -0.3, 1.2}), 255);
  const Costmap shelf = comfort_of(person, {{"shelf", make_pose({0, 0, 2.4}), {3, 3, 0.05}, true}});
  EXPECT_LT(value_at(shelf, {0.4, -0.2, 1.1}), 255);
}

TEST(Watch, notices_moves_turns_and_furniture_only_beyond_its_thresholds) {
  Watch watch(0.03, 0.1);
  const std::vector<SceneBox> boxes = {{"table", make_pose({1, 0, 0.7}), {1, 1, 0.04}, true}};
  EXPECT_TRUE(watch.changed(standing({0, 0, 0}, 0), boxes));
  EXPECT_FALSE(watch.changed(standing({0, 0, 0}, 0), boxes));
  EXPECT_FALSE(watch.changed(standing({0.02, 0, 0}, 0), boxes));
  EXPECT_TRUE(watch.changed(standing({0.04, 0, 0}, 0), boxes))
      << "measured from where the last map was made";
  EXPECT_TRUE(watch.changed(standing({0.04, 0, 0}, 0.2), boxes));
  Person looks_up = standing({0.04, 0, 0}, 0.2);
  looks_up.gaze_known = true;
  looks_up.gaze_direction = Vector3::UnitZ();
  EXPECT_TRUE(watch.changed(looks_up, boxes));
  EXPECT_FALSE(watch.changed(looks_up, boxes));
  EXPECT_TRUE(watch.changed(standing({0.04, 0, 0}, 0.2), boxes));
  EXPECT_TRUE(watch.changed(standing({0.04, 0, 0}, 0.2), {}));
  EXPECT_FALSE(watch.changed(standing({0.04, 0, 0}, 0.2), {}));
}

TEST(NearestPerson, is_the_nearest_or_nobody) {
  HumanState people;
  EXPECT_EQ(nearest_person(people, {0, 0, 0}), nullptr);
  people.people = {standing({3, 0, 0}, 0), standing({1, 0, 0}, 0)};
  people.people[1].id = "ben";
  EXPECT_EQ(nearest_person(people, {0, 0, 0})->id, "ben");
}

}  // namespace
}  // namespace handsel::costmap::costmap_test
