// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "common/cost/human_cost.hpp"
#include "tests/support/planar_arm.hpp"

namespace handsel::cost_property_test {
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
    person.joints =
        standing_body({place(random), place(random), 0}, angle(random), 1.5 + 0.3 * weight(random));
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

std::vector<const detail::CostKernel*> kernels() {
  std::vector<const detail::CostKernel*> out = {&detail::kCostKernelBase, &detail::cost_kernel()};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    out.push_back(&detail::kCostKernelAvx2);
#endif
  return out;
}

Person somebody(std::mt19937& random, const std::string& id) {
  std::uniform_real_distribution<double> place(-1.5, 1.5), angle(-3, 3);
  Person person;
  person.id = id;
  const Vector3 feet(place(random), place(random), 0);
  person.joints = angle(random) > 0 ? standing_body(feet, angle(random), 1.75)
                                    : sitting_body(feet, angle(random), 1.6);
  if (angle(random) > 0) {
    person.gaze_known = true;
    person.gaze_origin = find_joint(person, "head")->position;
    person.gaze_direction = Vector3(place(random), place(random), place(random)).normalized();
  }
  return person;
}

TEST(CostProperty, many_states_at_once_cost_what_they_cost_one_by_one) {
  std::mt19937 random(kSeed + 3);
  std::printf("seed %u\n", kSeed + 3);
  std::uniform_real_distribution<double> place(-1, 1), angle(-2.9, 2.9);
  double worst = 0;
  int points = 0, jumps = 0;
  const RobotModel jido = RobotModel::load(std::string(HANDSEL_SOURCE_DIR) +
                                           "/deploy/robots/jido/jido.txtpb"),
                   planar = test::planar_arm();
  for (const RobotModel* robot : {&jido, &planar}) {
    const std::vector<int> axes =
        robot == &jido ? jido.require_group("arm").axes : std::vector<int>{0, 1, 2};
    CostSettings settings;
    HumanCost cost(*robot, settings), exact(*robot, settings);
    for (int k = 0; k < 40; ++k) {
      HumanState people;
      people.people = {somebody(random, "anna")};
      if (k % 3 == 0) people.people.push_back(somebody(random, "ben"));
      const Pose T_world_base =
          make_pose({50 * place(random), 5 * place(random), place(random)},
                    Eigen::Quaterniond(1, 0.1 * place(random), 0.1 * place(random), place(random))
                        .normalized());
      for (Person& person : people.people) {
        for (BodyJoint& joint : person.joints) joint.position += T_world_base.translation();
        person.gaze_origin += T_world_base.translation();
      }
      if (k % 2 == 0) cost.set_moving_axes(axes);
      for (HumanCost* one : {&cost, &exact}) {
        one->set_people(people);
        one->set_base(T_world_base);
      }
      if (k % 2 == 1) cost.set_moving_axes(axes);
      Vector from = robot->rest_configuration(), to = from;
      if (k % 5 == 0)
        from[robot->dof() - 1] = to[robot->dof() - 1] +=
            0.1;  // another axis moved: the capsules are recomputed
      for (int axis : axes) from[axis] = angle(random), to[axis] = angle(random);
      std::vector<double> at, costs(40);
      for (int i = 0; i < 40; ++i) at.push_back(i / 39.0);
      cost.on_line(from, to, at.data(), 40, costs.data());
      for (std::size_t i = 0; i < at.size(); ++i) {
        const Vector q = from + at[i] * (to - from);
        const double one_by_one = weighted_cost(exact.parts(q), settings);
        const double apart = std::abs(costs[i] - one_by_one);
        ++points;
        jumps += apart > 2e-4;
        if (apart <= 2e-4) worst = std::max(worst, apart);
        ASSERT_EQ(cost(from + at[0] * (to - from)), costs[0]);
      }
    }
  }
  std::printf("within %.1e but for %d of %d states, where the comfort of the arm jumps\n", worst,
              jumps, points);
  EXPECT_LE(jumps, points / 500);
}

TEST(CostProperty, every_width_gives_the_same_bits) {
  const RobotModel jido =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  std::mt19937 random(kSeed + 4);
  std::uniform_real_distribution<double> angle(-2.9, 2.9);
  BatchCost wide(jido, robot_capsules(jido),
                 {{jido.tool_link(), Vector3::Zero()}, {jido.tool_link(), Vector3(0.1, 0, 0)}});
  const std::vector<int>& axes = jido.require_group("arm").axes;
  wide.set_axes(axes);
  for (int k = 0; k < 30; ++k) {
    const Person person = somebody(random, "anna");
    wide.set_people({{simplified_body(person), sight_of(person)}}, 1.0, 3.0);
    Vector from = jido.rest_configuration(), to = from;
    for (int axis : axes) from[axis] = angle(random), to[axis] = angle(random);
    double at[BatchCost::kStates];
    for (int i = 0; i < BatchCost::kStates; ++i) at[i] = i / 15.0;
    std::vector<double> first;
    for (const detail::CostKernel* kernel : kernels()) {
      wide.set_kernel(*kernel);
      ASSERT_TRUE(wide.run(from, to, at, BatchCost::kStates, 2));
      std::vector<double> all;
      for (int lane = 0; lane < BatchCost::kStates; ++lane)
        for (double x : {wide.safety(0, lane), wide.visibility(0, lane), wide.point(0, lane).x(),
                         wide.point(1, lane).z()})
          all.push_back(x);
      if (first.empty()) first = all;
      ASSERT_EQ(all, first) << kernel->name;
    }
  }
}

TEST(CostProperty, states_that_are_none_are_left_to_the_exact_way) {
  const RobotModel robot = test::planar_arm();
  HumanCost cost(robot, {});
  cost.set_moving_axes({0, 1, 2});
  HumanState people;
  std::mt19937 random(kSeed);
  people.people = {somebody(random, "anna")};
  cost.set_people(people);
  Vector q = Vector::Zero(3);
  q[1] = 1e4;
  EXPECT_EQ(cost(q), weighted_cost(cost.parts(q), {}));
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
    const Vector3 a(place(random), place(random), 1 + place(random)),
        b(place(random), place(random), 1 + place(random));
    const double exact = simplified_distance(body, a, b, 0.05);
    double sampled = 1e9;
    for (int i = 0; i < 4000; ++i) {
      const double turn = 2 * M_PI * unit(random), r = body.radius * std::sqrt(unit(random));
      const Vector3 p(r * std::cos(turn), r * std::sin(turn), body.height * unit(random));
      const Vector3 q = a + unit(random) * (b - a);
      sampled = std::min(
          {sampled, (p - q).norm() - 0.05, (body.head - q).norm() - body.head_radius - 0.05});
    }
    if (exact <= 0) continue;
    ASSERT_LE(exact, sampled + 1e-9) << "case " << k;
    ASSERT_GE(exact, sampled - 0.35) << "case " << k;
  }
}

}  // namespace
}  // namespace handsel::cost_property_test
