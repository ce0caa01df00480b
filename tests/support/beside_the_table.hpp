// SPDX-License-Identifier: Apache-2.0
// Jido, a table and a person beside it: random queries obstructed by the person, for tests and
// benchmarks.
#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <string>

#include "components/costmap/layers.hpp"
#include "components/path_planner/problem.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::test {

struct BesideTheTable {
  static constexpr double kNearer =
      0.1;  ///< the line between the ends comes this much nearer to the person than they are [m]

  explicit BesideTheTable(unsigned seed) : random(seed) {
    scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
    world.set_scene(scene);
    problem.axes = robot.require_group("arm").axes;
    problem.budget = 2000000;
  }
  BesideTheTable(const BesideTheTable&) = delete;

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }

  Vector part(const Vector& q) const { return RobotModel::part(q, robot.require_group("arm")); }
  Vector whole(const Vector& q) const {
    return RobotModel::with(problem.start, robot.require_group("arm"), q);
  }

  Vector draw() {
    Vector q = robot.rest_configuration();
    do {
      for (int axis : problem.axes)
        q[axis] = between(robot.axes()[axis].lower, robot.axes()[axis].upper);
    } while (!world.check(q).free);
    return q;
  }

  /// Somebody else, another start and goal.
  void next_query() {
    people = person_at({between(1.05, 1.15), between(-0.05, 0.05), 0});
    world.set_people(people);
    cost.set_people(people);
    layers = {std::make_shared<CostGrid>(maps.make(people.people[0], scene.boxes)[2]), {}};
    cost.set_layers(layers);
    Vector goal;
    for (bool in_the_way = false; !in_the_way;) {
      problem.start = draw();
      goal = draw();
      const double ends = std::min(cost.parts(problem.start).distance, cost.parts(goal).distance);
      for (double t = 0.02; t < 1 && !in_the_way; t += 0.02)
        in_the_way =
            cost.parts(problem.start + t * (goal - problem.start)).distance < ends - kNearer;
    }
    problem.goals = {part(goal)};
  }

  RobotModel robot{
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb")};
  CollisionWorld world{robot, nullptr};
  HumanCost cost{robot, {}};
  costmap::MapMaker maps{{}};
  std::mt19937 random;
  Scene scene;
  HumanState people;
  LayersNow layers;
  path_planner::Problem problem;
};

}  // namespace handsel::test
