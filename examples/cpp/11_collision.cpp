// SPDX-License-Identifier: Apache-2.0
// Distances of a robot to a box and to a person, and the first contact on a straight motion.
#include <cstdio>

#include <handsel/collision.hpp>

int main(int argc, char** argv) {
  const handsel::RobotModel robot = handsel::RobotModel::load(
      handsel::find_file(handsel::FileKind::robot, argc > 1 ? argv[1] : "jido"));
  handsel::CollisionWorld world(robot, [](const std::string&) { return nullptr; });
  const handsel::Vector rest = robot.rest_configuration();
  const handsel::Vector3 tool = robot.link_pose(rest, robot.tool_link()).translation();

  const handsel::Pose box = handsel::make_pose(tool + handsel::Vector3(0, 0, 0.5));
  world.set_obstacles({{"lamp", {handsel::Box{{0.2, 0.2, 0.2}}, box}}});
  std::printf("to the lamp %.3f m\n", world.distance_to_scene(rest));

  handsel::Person person;
  person.id = "anna";
  person.joints = handsel::standing_body({tool.x() + 1.0, tool.y(), 0}, 3.14, 1.75);
  handsel::HumanState people;
  people.people = {person};
  world.set_people(people);
  std::printf("to the person %.3f m\n", world.distance_to_people(rest));

  const handsel::Group& arm = robot.require_group("arm");
  handsel::Pose inside = robot.link_pose(rest, arm.tip);
  inside.translation().z() += 0.4;
  const auto found = robot.inverse(arm, inside, rest);
  if (!found) return std::puts("out of reach"), 1;
  const auto verdict = world.check_motion(rest, handsel::RobotModel::with(rest, arm, *found));
  if (verdict.free) return std::puts("free"), 0;
  std::printf("%s touches %s\n", verdict.first.c_str(), verdict.second.c_str());
  return 0;
}
