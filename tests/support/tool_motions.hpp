// SPDX-License-Identifier: Apache-2.0
// Random tool motions of an arm with shoulder, elbow and wrist, near a configuration.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "common/model/srs_arm.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"

namespace handsel::test {

/// Returns a motion with two to five waypoints, every second one with its elbow; without waypoints
/// if none was found. `also`: further active axes.
inline trajectory_planner::CartesianRequest tool_motion(const RobotModel& robot, const Group& arm,
                                                        const std::vector<int>& also,
                                                        const Vector& home, CollisionWorld& world,
                                                        std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const ik::Chain chain(robot, arm, home);
  const ik::SrsArm srs = *ik::SrsArm::recognise(chain);
  trajectory_planner::CartesianRequest request;
  request.start = home;
  request.also = also;
  const int nodes = 2 + static_cast<int>(random() % 4);
  Vector q = home;
  for (int k = 0; k < nodes; ++k) {
    Vector next = q;
    for (std::size_t i = 0; i < arm.axes.size(); ++i) {
      const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[i])];
      double& value = next[arm.axes[i]];
      const double moved =
          std::clamp(value + between(-0.6, 0.6), axis.lower + 0.2, axis.upper - 0.2);
      const bool bends = i == 1 || i == 3 || i == 5;
      value = bends && (moved * home[arm.axes[i]] < 0 || std::abs(moved) < 0.15) ? value : moved;
    }
    if (!world.is_free(next)) continue;
    q = next;
    trajectory_planner::CartesianWaypoint node;
    node.T_root_tool = chain.forward(RobotModel::part(q, arm), nullptr);
    if (k % 2 == 0) node.elbow = srs.elbow_angle(RobotModel::part(q, arm));
    node.also = Vector(static_cast<Eigen::Index>(also.size()));
    for (std::size_t i = 0; i < also.size(); ++i) {
      const Axis& axis = robot.axes()[static_cast<std::size_t>(also[i])];
      node.also[static_cast<Eigen::Index>(i)] =
          std::clamp(home[also[i]] + between(-0.1, 0.1), axis.lower, axis.upper);
    }
    request.nodes.push_back(node);
  }
  return request;
}

/// Hand and head of Jido: with the tool and the elbow 22 active axes.
inline std::vector<int> hand_and_head(const RobotModel& robot) {
  std::vector<int> axes = robot.require_group("hand").axes;
  axes.insert(axes.end(), robot.require_group("head").axes.begin(),
              robot.require_group("head").axes.end());
  return axes;
}

/// Returns a configuration of the iiwa with free space around it.
inline Vector iiwa_home() {
  Vector home(7);
  home << 0.2, 0.6, -0.3, -1.4, 0.3, 0.9, 0.1;
  return home;
}

}  // namespace handsel::test
