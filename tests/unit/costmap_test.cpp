#include <cmath>

#include <gtest/gtest.h>

#include "common/cost/human_cost.hpp"
#include "components/costmap/comfort_map.hpp"

namespace handsel::costmap {
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

Vector3 point(const Costmap& map, std::size_t index) {
  const std::size_t i = index % map.nx, j = index / map.nx % map.ny, k = index / map.nx / map.ny;
  return map.origin + map.resolution * Vector3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
}

TEST(ComfortMap, agrees_with_the_cost_it_is_made_from) {
  const Person person = standing({1, 0.5, 0}, 0.7);
  const Costmap map = MapMaker({}).make(person, {});
  ASSERT_EQ(map.values.size(), std::size_t{map.nx} * map.ny * map.nz);
  EXPECT_EQ(map.person, "anna");
  int reachable = 0, unlike = 0, rough = 0;
  double error = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double exact = arm_comfort_cost(person, point(map, i));
    if ((map.values[i] == 255) != (exact >= 1.0)) {
      ++unlike;
    } else if (exact < 1.0) {
      ++reachable;
      error += std::abs(map.values[i] / 254.0 - exact);
      rough += std::abs(map.values[i] / 254.0 - exact) > 0.12;
    }
  }
  EXPECT_GT(reachable, 2000);
  EXPECT_LT(error / reachable, 0.03);
  EXPECT_LT(rough, reachable / 50) << "where the posture jumps";
  EXPECT_LT(unlike, reachable / 5) << "only cells at the edge of the volume may differ";
}

TEST(ComfortMap, a_comfortable_point_is_better_than_a_stretched_one) {
  const Costmap map = MapMaker({}).make(standing({0, 0, 0}, 0), {});
  EXPECT_LT(value_at(map, {0.35, -0.2, 1.1}), value_at(map, {0.1, -0.25, 1.9}));
  EXPECT_EQ(value_at(map, {-0.6, 0, 1.1}), 255) << "behind the back";
}

TEST(ComfortMap, under_inside_and_near_a_table_is_no_place) {
  const Person person = standing({0, 0, 0}, 0);
  const std::vector<SceneBox> table = {{"table", make_pose({0.6, 0, 1.0}), {0.7, 1.2, 0.04}, true}};
  const Costmap free = MapMaker({}).make(person, {}), map = MapMaker({}).make(person, table);
  for (const Vector3& p : {Vector3(0.3, -0.25, 0.95), Vector3(0.3, -0.25, 1.0), Vector3(0.3, -0.25, 1.05)}) {
    EXPECT_LT(value_at(free, p), 255);
    EXPECT_EQ(value_at(map, p), 255);
  }
  EXPECT_LT(value_at(free, {0.3, -0.25, 1.25}), 255);
  EXPECT_EQ(value_at(map, {0.3, -0.25, 1.25}), value_at(free, {0.3, -0.25, 1.25}));
}

TEST(ComfortMap, behind_a_wall_is_no_place_and_a_shelf_overhead_does_no_harm) {
  const Person person = standing({0, 0, 0}, 0);
  const Costmap wall = MapMaker({}).make(person, {{"wall", make_pose({0.3, 0, 1.25}), {0.05, 4, 2.5}, false}});
  EXPECT_EQ(value_at(wall, {0.5, -0.2, 1.2}), 255);
  EXPECT_LT(value_at(wall, {0.2, -0.3, 1.2}), 255);
  const Costmap shelf = MapMaker({}).make(person, {{"shelf", make_pose({0, 0, 2.4}), {3, 3, 0.05}, true}});
  EXPECT_LT(value_at(shelf, {0.4, -0.2, 1.1}), 255);
}

TEST(Watch, notices_moves_turns_and_furniture_only_beyond_its_thresholds) {
  Watch watch(0.03, 0.1);
  const std::vector<SceneBox> boxes = {{"table", make_pose({1, 0, 0.7}), {1, 1, 0.04}, true}};
  EXPECT_TRUE(watch.changed(standing({0, 0, 0}, 0), boxes));
  EXPECT_FALSE(watch.changed(standing({0, 0, 0}, 0), boxes));
  EXPECT_FALSE(watch.changed(standing({0.02, 0, 0}, 0), boxes));
  EXPECT_TRUE(watch.changed(standing({0.04, 0, 0}, 0), boxes)) << "measured from where the last map was made";
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
}  // namespace handsel::costmap
