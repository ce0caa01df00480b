// SPDX-License-Identifier: Apache-2.0
// Random polylines of Jido's arm among random boxes; their segments are free.
#pragma once

#include <algorithm>
#include <random>

#include "components/trajectory_planner/trajectory_planner.hpp"

namespace handsel::test {

struct BrokenLine {
  Scene scene;
  TrajectoryRequest request;
};

/// Returns a random polyline with `least` to `most` waypoints, at least 3; sets the scene of
/// `world`.
inline BrokenLine broken_line(const RobotModel& robot, CollisionWorld& world, int least, int most,
                              std::mt19937& random) {
  constexpr double kLegStep = 2e-4;  // step of the path planner's final check [rad]
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Group& arm = robot.require_group("arm");
  for (;;) {
    BrokenLine line;
    for (int i = 0; i < 6; ++i)
      line.scene.boxes.push_back(
          {"box " + std::to_string(i),
           make_pose({between(0.4, 1.1), between(-0.9, 0.6), between(0.4, 1.6)}),
           {between(0.03, 0.3), between(0.03, 0.3), between(0.03, 0.3)},
           false});
    world.set_scene(line.scene);
    TrajectoryRequest& request = line.request;
    request.id = {1, 0};
    request.group = "arm";
    request.start = robot.rest_configuration();
    if (!world.is_free(request.start)) continue;
    Vector at = request.start;
    request.nodes = {RobotModel::part(at, arm)};
    const int nodes = least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
    for (int tries = 0; tries < 40 && static_cast<int>(request.nodes.size()) < nodes; ++tries) {
      Vector next = at;
      for (const int axis : arm.axes)
        next[axis] = std::clamp(at[axis] + between(-0.7, 0.7),
                                robot.axes()[static_cast<std::size_t>(axis)].lower,
                                robot.axes()[static_cast<std::size_t>(axis)].upper);
      if (!world.check_motion(at, next, kLegStep).free) continue;
      at = next;
      request.nodes.push_back(RobotModel::part(at, arm));
    }
    if (static_cast<int>(request.nodes.size()) >= least) return line;
  }
}

}  // namespace handsel::test
