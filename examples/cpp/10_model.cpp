// SPDX-License-Identifier: Apache-2.0
// Reads a robot, moves its tool up by 10 cm with inverse kinematics, and finds how fast that is.
#include <cstdio>

#include <handsel/model.hpp>
#include <handsel/trajectory.hpp>

int main(int argc, char** argv) {
  try {
    const handsel::RobotModel robot = handsel::RobotModel::load(
        handsel::find_file(handsel::FileKind::robot, argc > 1 ? argv[1] : "jido"));
    const handsel::Group& arm = robot.require_group("arm");
    const handsel::Vector start = robot.rest_configuration();
    handsel::Pose target = robot.link_pose(start, arm.tip);
    target.translation().z() += 0.1;
    const auto found = robot.inverse(arm, target, start);
    if (!found) return std::puts("out of reach"), 1;
    const handsel::Vector goal = handsel::RobotModel::with(start, arm, *found);
    const double error =
        (robot.link_pose(goal, arm.tip).translation() - target.translation()).norm();
    const handsel::Solution motion = handsel::solve(
        handsel::rest_state(start), handsel::rest_state(goal), robot.comfort_limits());
    std::printf("%s: %d axes, error %.1f mm, %.2f s\n", robot.name().c_str(), robot.dof(),
                1000 * error, motion.trajectory.duration());
  } catch (const handsel::MissingError& error) {
    return std::printf("missing: %s\n", error.what()), 1;
  } catch (const handsel::ConfigError& error) {
    return std::printf("refused: %s\n", error.what()), 1;
  }
  return 0;
}
