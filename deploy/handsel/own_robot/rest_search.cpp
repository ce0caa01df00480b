// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/rest_search.hpp"

#include <algorithm>
#include <numbers>
#include <random>

#include "deploy/handsel/own_robot/collision_matrix.hpp"

namespace handsel {
namespace {

/// Returns the links from the second joint of the arm to its tip: the first turns in place.
std::vector<std::size_t> moved_links(const RobotModel& robot, const Group& arm) {
  std::vector<std::size_t> out;
  for (std::size_t i = 1; i < arm.axes.size(); ++i) {
    const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[i])];
    out.push_back(
        static_cast<std::size_t>(robot.joints()[static_cast<std::size_t>(axis.joint)].child));
  }
  return out;
}

double score(const RobotModel& robot, const Group& arm, const Vector& q,
             const RestSettings& settings) {
  double margin = 1, turned = 0;
  for (const int i : arm.axes) {
    const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
    // Of a joint of several turns, one turn counts.
    const double range = std::min(axis.upper - axis.lower, 2 * std::numbers::pi);
    margin = std::min(margin, std::min(q[i] - axis.lower, axis.upper - q[i]) / range);
    turned += std::abs(q[i]);
  }
  std::vector<Pose> T;
  robot.forward(q, T);
  double lowest = 1e9;
  for (const std::size_t link : moved_links(robot, arm))
    lowest = std::min(lowest, T[link].translation().z());
  return settings.limit_weight * std::min(margin, 0.25) + settings.height_weight * lowest -
         settings.turn_weight * turned;
}

/// Rotation that brings the axis `reach` of the tool down, turned by `yaw` about the vertical.
Eigen::Quaterniond pointing_down(const Vector3& reach, double yaw) {
  return Eigen::AngleAxisd(yaw, Vector3::UnitZ()) *
         Eigen::Quaterniond::FromTwoVectors(reach, -Vector3::UnitZ());
}

}  // namespace

ArmSize size_of_arm(const RobotModel& robot, const Pose& T_tool_grasp) {
  constexpr int kSamples = 3000;
  const Group& arm = robot.require_group("arm");
  ArmSize size;
  std::mt19937_64 random(1);
  std::vector<Pose> T;
  const auto second = moved_links(robot, arm).front();
  robot.forward(robot.rest_configuration(), T);
  size.shoulder = T[second].translation();
  Vector q = robot.rest_configuration();
  for (int n = 0; n < kSamples; ++n) {
    for (const int i : arm.axes) {
      const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
      q[i] = std::uniform_real_distribution<double>(axis.lower, axis.upper)(random);
    }
    robot.forward(q, T);
    const Vector3 grasp =
        T[static_cast<std::size_t>(robot.tool_link())] * T_tool_grasp.translation();
    size.reach = std::max(size.reach, (grasp - T[second].translation()).norm());
  }
  return size;
}

std::optional<Vector> find_rest(const RobotModel& robot, const Pose& T_tool_grasp,
                                const Vector3& tool_direction, const RestSettings& settings) {
  constexpr int kYaws = 8, kRestarts = 6;
  const Group& arm = robot.require_group("arm");
  const ArmSize size = size_of_arm(robot, T_tool_grasp);
  const Vector3 offset = T_tool_grasp.translation();
  std::optional<Vector> best;
  double highest = -1e9;
  std::uint64_t seed = 1;
  for (const double ahead : settings.ahead)
    for (const double above : settings.above)
      for (int turn = 0; turn < kYaws; ++turn) {
        const Eigen::Quaterniond R =
            pointing_down(tool_direction, turn * 2 * std::numbers::pi / kYaws);
        const Vector3 grasp = size.shoulder + size.reach * Vector3(ahead, 0, above);
        IkOptions options;
        options.restarts = 1;
        Vector from = robot.rest_configuration();
        std::mt19937_64 random(seed++);
        for (int restart = 0; restart < kRestarts; ++restart) {
          options.random_seed = random();
          const auto q = robot.inverse(arm, make_pose(grasp - R * offset, R), from, options);
          for (const int i : arm.axes) {
            const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
            const double bound = std::numbers::pi;  // seeds within one turn
            from[i] = std::uniform_real_distribution<double>(std::max(axis.lower, -bound),
                                                             std::min(axis.upper, bound))(random);
          }
          if (!q) continue;
          const Vector all = RobotModel::with(robot.rest_configuration(), arm, *q);
          const double value = score(robot, arm, all, settings);
          if (value <= highest || !overlapping_hulls(robot, all).empty()) continue;
          highest = value;
          best = all;
        }
      }
  return best;
}

}  // namespace handsel
