// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel::cost_test {
namespace {

Person standing(const Vector3& feet, double yaw) {
  Person person;
  person.id = "anna";
  person.joints = standing_body(feet, yaw, 1.75);
  return person;
}

TEST(SafetyCost, is_one_at_contact_and_zero_from_the_radius_on) {
  EXPECT_DOUBLE_EQ(safety_cost(0.0, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(safety_cost(-0.5, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(safety_cost(1.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(safety_cost(5.0, 1.0), 0.0);
  EXPECT_NEAR(safety_cost(0.5, 1.0), (std::exp(-0.5) - std::exp(-1.0)) / (1 - std::exp(-1.0)),
              1e-12);
}

TEST(VisibilityCost, grows_from_the_gaze_to_the_back_and_ends_at_the_cutoff) {
  Person person = standing({0, 0, 0}, 0);
  person.gaze_known = true;
  person.gaze_origin = {0, 0, 1.6};
  person.gaze_direction = Vector3::UnitX();
  EXPECT_NEAR(visibility_cost(person, {1, 0, 1.6}, 3.0), 0.0, 1e-9);
  EXPECT_NEAR(visibility_cost(person, {0, 1, 1.6}, 3.0), 0.5, 1e-9);
  EXPECT_NEAR(visibility_cost(person, {-1, 0, 1.6}, 3.0), 1.0, 1e-9);
  EXPECT_EQ(visibility_cost(person, {-4, 0, 1.6}, 3.0), 0.0);
}

TEST(VisibilityCost, without_a_gaze_the_front_of_the_body_stands_in) {
  const Person person = standing({0, 0, 0}, M_PI / 2);
  EXPECT_NEAR(torso_axes(person).col(0).dot(Vector3::UnitY()), 1.0, 1e-6);
  EXPECT_LT(visibility_cost(person, {0, 1, 1.6}, 3.0), 0.1);
  EXPECT_GT(visibility_cost(person, {0, -1, 1.6}, 3.0), 0.9);
}

TEST(ArmComfort, in_front_of_the_chest_is_better_than_overhead_and_far_is_out_of_reach) {
  const Person person = standing({0, 0, 0}, 0);
  const double chest = arm_comfort_cost(person, {0.35, -0.15, 1.1}),
               overhead = arm_comfort_cost(person, {0.1, -0.2, 1.85});
  EXPECT_LT(chest, 0.4);
  EXPECT_GT(overhead, chest);
  EXPECT_LT(overhead, 1.0);
  EXPECT_EQ(arm_comfort_cost(person, {1.5, 0, 1.1}), 1.0);
  EXPECT_FALSE(within_reach(person, {1.5, 0, 1.1}));
  EXPECT_TRUE(within_reach(person, {0.35, -0.15, 1.1}));
  EXPECT_FALSE(within_reach(person, {-0.55, 0, 1.1})) << "behind the back";
}

TEST(ArmComfort, is_the_same_for_left_and_right_mirrored) {
  const Person person = standing({0, 0, 0}, 0);
  EXPECT_NEAR(arm_comfort_cost(person, Side::left, {0.3, 0.2, 1.2}),
              arm_comfort_cost(person, Side::right, {0.3, -0.2, 1.2}), 1e-6);
}

TEST(ArmComfort, a_body_without_arms_reaches_nothing) {
  EXPECT_EQ(arm_comfort_cost(Person{}, {0.3, 0, 1}), 1.0);
}

TEST(HumanCost, is_zero_without_people_and_larger_toward_them) {
  const RobotModel robot = test::planar_arm();
  HumanCost cost(robot, {});
  cost.set_base(make_pose({0, 0, 1.1}));
  Vector q = Vector::Zero(3);
  EXPECT_FALSE(cost.anyone());
  EXPECT_EQ(cost(q), 0.0);
  HumanState people;
  people.people.push_back(standing({1.6, 0, 0}, M_PI));
  cost.set_people(people);
  const double toward = cost(q), distance = cost.parts(q).distance;
  q[0] = 1.6;
  EXPECT_GT(toward, cost(q));
  EXPECT_LT(distance, cost.parts(q).distance);
}

TEST(HumanCost, takes_the_person_it_is_worst_for) {
  const RobotModel robot = test::planar_arm();
  HumanCost cost(robot, {});
  cost.set_base(make_pose({0, 0, 1.1}));
  HumanState people;
  people.people.push_back(standing({1.6, 0, 0}, M_PI));
  cost.set_people(people);
  const double alone = cost(Vector::Zero(3));
  people.people.push_back(standing({-9, 0, 0}, 0));
  cost.set_people(people);
  EXPECT_DOUBLE_EQ(cost(Vector::Zero(3)), alone);
}

TEST(SimplifiedDistance, to_cylinder_side_top_and_head) {
  SimplifiedBody body;
  body.height = 1.4;
  body.radius = 0.25;
  body.head = {0, 0, 1.65};
  body.head_radius = 0.12;
  EXPECT_NEAR(simplified_distance(body, {1, -1, 1}, {1, 1, 1}, 0.05), 0.7, 1e-6);
  EXPECT_NEAR(simplified_distance(body, {-1, 0, 2}, {1, 0, 2}, 0.05), 2 - 1.65 - 0.12 - 0.05, 1e-6);
  EXPECT_NEAR(simplified_distance(body, {0.24, 0, 1.5}, {0.24, 0, 1.9}, 0.0), 0.1, 1e-6);
}

}  // namespace
}  // namespace handsel::cost_test
