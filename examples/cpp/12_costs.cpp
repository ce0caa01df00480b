// SPDX-License-Identifier: Apache-2.0
// Human-aware costs of a point in front of a person and behind the person, and of a robot.
#include <cstdio>

#include <handsel/cost.hpp>

int main(int argc, char** argv) {
  const handsel::RobotModel robot = handsel::RobotModel::load(
      handsel::find_file(handsel::FileKind::robot, argc > 1 ? argv[1] : "jido"));
  handsel::Person person;
  person.id = "anna";
  person.joints = handsel::standing_body({1.5, 0, 0}, 3.14, 1.75);  // faces the robot at 0, 0
  const handsel::CostSettings settings;
  for (const double x : {1.05, 1.95}) {
    const handsel::CostParts parts = handsel::point_cost(person, {x, -0.2, 1.1}, settings);
    std::printf("x %.2f m: safety %.2f, visibility %.2f, arm comfort %.2f, sum %.2f\n", x,
                parts.safety, parts.visibility, parts.comfort,
                handsel::weighted_cost(parts, settings));
  }
  handsel::HumanCost cost(robot, settings);
  handsel::HumanState people;
  people.people = {person};
  cost.set_people(people);
  std::printf("robot: %.2f\n", cost(robot.rest_configuration()));
  return 0;
}
