#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "common/cost/human_cost.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel {
namespace {

constexpr unsigned kSeed = 77;

TEST(CostProperty, every_cost_is_in_the_unit_interval) {
  std::mt19937 random(kSeed);
  RecordProperty("seed", kSeed);
  std::uniform_real_distribution<double> place(-1.5, 1.5), angle(-2.9, 2.9), weight(0, 2);
  const RobotModel robot = test::planar_arm();
  for (int k = 0; k < 500; ++k) {
    CostSettings settings;
    settings.w_safety = weight(random) + 0.01;
    settings.w_visibility = weight(random);
    settings.w_comfort = weight(random);
    HumanCost cost(robot, settings);
    cost.set_base(make_pose({place(random), place(random), 1.0}));
    HumanState people;
    Person person;
    person.joints = standing_body({place(random), place(random), 0}, angle(random), 1.5 + 0.3 * weight(random));
    people.people.push_back(person);
    cost.set_people(people);
    for (int i = 0; i < 5; ++i) {
      const double value = cost(Vector3(angle(random), angle(random), angle(random)));
      ASSERT_GE(value, 0.0) << "case " << k;
      ASSERT_LE(value, 1.0) << "case " << k;
    }
    const Vector3 p(place(random), place(random), 1 + place(random));
    ASSERT_GE(arm_comfort_cost(person, p), 0.0);
    ASSERT_LE(arm_comfort_cost(person, p), 1.0);
    ASSERT_EQ(within_reach(person, p), arm_comfort_cost(person, p) < 1.0);
    ASSERT_GE(visibility_cost(person, p, 3), 0.0);
    ASSERT_LE(visibility_cost(person, p, 3), 1.0);
  }
}

TEST(CostProperty, safety_falls_strictly_with_distance) {
  double last = safety_cost(0.0, 1.3);
  for (int i = 1; i <= 1300; ++i) {
    const double now = safety_cost(0.001 * i, 1.3);
    ASSERT_LT(now, last + (i == 1300 ? 1e-12 : 0)) << i;
    last = now;
  }
  EXPECT_NEAR(last, 0.0, 1e-9);
}

TEST(CostProperty, simplified_distance_agrees_with_points_sampled_on_the_body) {
  std::mt19937 random(kSeed + 1);
  std::uniform_real_distribution<double> place(-1.5, 1.5), unit(0, 1);
  SimplifiedBody body;
  body.height = 1.4;
  body.radius = 0.25;
  body.head = {0.05, 0, 1.6};
  body.head_radius = 0.13;
  for (int k = 0; k < 200; ++k) {
    const Vector3 a(place(random), place(random), 1 + place(random)), b(place(random), place(random), 1 + place(random));
    const double exact = simplified_distance(body, a, b, 0.05);
    double sampled = 1e9;
    for (int i = 0; i < 4000; ++i) {
      const double turn = 2 * M_PI * unit(random), r = body.radius * std::sqrt(unit(random));
      const Vector3 p(r * std::cos(turn), r * std::sin(turn), body.height * unit(random));
      const Vector3 q = a + unit(random) * (b - a);
      sampled = std::min({sampled, (p - q).norm() - 0.05, (body.head - q).norm() - body.head_radius - 0.05});
    }
    if (exact <= 0) continue;
    ASSERT_LE(exact, sampled + 1e-9) << "case " << k;
    ASSERT_GE(exact, sampled - 0.35) << "case " << k;
  }
}

}  // namespace
}  // namespace handsel
