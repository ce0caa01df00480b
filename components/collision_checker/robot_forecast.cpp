// SPDX-License-Identifier: Apache-2.0
#include "components/collision_checker/robot_forecast.hpp"

#include <algorithm>

#include "common/collision/collision_world.hpp"

namespace handsel::collision_checker {
namespace {

/// Returns whether an axis of the robot moves the link.
bool is_moved(const RobotModel& robot, int link) {
  for (int joint = robot.links()[static_cast<std::size_t>(link)].parent_joint; joint >= 0;) {
    const auto& above = robot.joints()[static_cast<std::size_t>(joint)];
    if (above.dof >= 0) return true;
    joint = robot.links()[static_cast<std::size_t>(above.parent)].parent_joint;
  }
  return false;
}

}  // namespace

RobotForecast::RobotForecast(const RobotModel& robot, double ahead) : robot_(robot), ahead_(ahead) {
  for (const LinkCapsule& capsule : robot_capsules(robot))
    if (is_moved(robot, capsule.link)) capsules_.push_back(capsule);
}

RobotApproach RobotForecast::approach(const Vector& q, const Pose& T_world_base, double time) {
  RobotApproach nearest;
  if (others_.empty()) return nearest;
  robot_.forward(q, links_);
  const double moved = std::min(time, ahead_);
  for (const LinkCapsule& capsule : capsules_) {
    const Pose T = T_world_base * links_[static_cast<std::size_t>(capsule.link)];
    const Vector3 a = T * capsule.a, b = T * capsule.b;
    for (const OtherRobot& robot : others_)
      for (const MovingPart& part : robot.parts) {
        const Vector3 c = part.a + moved * part.velocity_a, d = part.b + moved * part.velocity_b;
        const double radii = capsule.radius + part.radius;
        const double bound = nearest.distance + radii + 0.5 * ((b - a).norm() + (d - c).norm());
        if (bound > 0 && (a + b - c - d).squaredNorm() >= 4.0 * bound * bound) continue;
        const double distance = segment_distance(a, b, c, d) - radii;
        if (distance >= nearest.distance) continue;
        const std::string& link = robot_.links()[static_cast<std::size_t>(capsule.link)].name;
        nearest = {distance, link, robot.name};
      }
  }
  return nearest;
}

}  // namespace handsel::collision_checker
