// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/path_motion.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

namespace {

void add_stop(const PathMotion& motion, const KinematicLimits& limits, int g,
              StopTable& table) noexcept {
  const double factor = static_cast<double>(g) / kStopGrid;
  const auto k = static_cast<std::size_t>(g);
  for (Eigen::Index i = 0; i < motion.velocity->size(); ++i) {
    const double v = factor * std::abs((*motion.velocity)[i]);
    if (v < 1e-9) continue;
    const double onward = (*motion.acceleration)[i] * std::copysign(1.0, (*motion.velocity)[i]);
    const double a = std::min(factor * factor * std::max(0.0, onward), limits.acceleration[i]);
    const double ease = a / limits.jerk[i];
    const double peak = v + 0.5 * a * ease;
    const double rest = stop_time(peak, limits.acceleration[i], limits.jerk[i]);
    table.time[k] = std::max(table.time[k], ease + rest);
    table.distance[k] = std::max(table.distance[k], peak / v * (ease + 0.5 * rest));
  }
}

}  // namespace

double stop_time(double v, double acceleration_limit, double jerk_limit) noexcept {
  const double x = std::abs(v);
  return x * jerk_limit < acceleration_limit * acceleration_limit
             ? 2.0 * std::sqrt(x / jerk_limit)
             : x / acceleration_limit + acceleration_limit / jerk_limit;
}

StopTable stop_table(const PathMotion& motion, const KinematicLimits& stop_limits) noexcept {
  StopTable table;
  for (int g = 1; g <= kStopGrid; ++g) add_stop(motion, stop_limits, g, table);
  return table;
}

MovingCapsule placed(const LinkCapsule& link, const PathMotion& motion,
                     const Pose& T_world_base) noexcept {
  const auto k = static_cast<std::size_t>(link.link);
  const Pose& T = (*motion.links)[k];
  const LinkTwist& twist = (*motion.twists)[k];
  const Eigen::Matrix3d& R = T_world_base.linear();
  const Vector3 ra = T.linear() * link.a, rb = T.linear() * link.b;
  const Vector3 origin = T_world_base * T.translation();
  return {origin + R * ra, origin + R * rb, R * (twist.linear + twist.angular.cross(ra)),
          R * (twist.linear + twist.angular.cross(rb)), link.radius};
}

}  // namespace handsel::trajectory_controller
