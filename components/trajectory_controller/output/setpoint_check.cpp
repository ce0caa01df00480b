// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/output/setpoint_check.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

bool acceptable(const MotionState3& previous, const MotionState3& next, Eigen::Index i,
                const KinematicLimits& guard, double dt) noexcept {
  const double q0 = previous.position[i], v0 = previous.velocity[i], a0 = previous.acceleration[i];
  const double q1 = next.position[i], v1 = next.velocity[i], a1 = next.acceleration[i];
  const double V = guard.velocity[i], A = guard.acceleration[i], J = guard.jerk[i];
  constexpr double kRounding = 1e-10;
  if (!std::isfinite(q1) || !std::isfinite(v1) || !std::isfinite(a1)) return false;
  const double room = 1.0 + kLimitTolerance;
  if (std::abs(v1) > V * room || std::abs(a1) > A * room ||
      std::abs(a1 - a0) > J * dt * room + kRounding)
    return false;
  // Jerk-limited motions stay this close to the trapezoid through their ends.
  if (std::abs(v1 - v0 - 0.5 * dt * (a0 + a1)) > 0.25 * J * dt * dt * room + kRounding)
    return false;
  if (std::abs(q1 - q0 - 0.5 * dt * (v0 + v1)) > 0.25 * J * dt * dt * dt * room + kRounding)
    return false;
  return std::abs(v1 + a1 * std::abs(a1) / (2.0 * J)) <= V * room;
}

void measure(const MotionState3& previous, const MotionState3& next, const KinematicLimits& guard,
             double dt, LimitRatios& ratios) noexcept {
  for (Eigen::Index i = 0; i < next.position.size(); ++i) {
    ratios.velocity = std::max(ratios.velocity, std::abs(next.velocity[i]) / guard.velocity[i]);
    ratios.acceleration =
        std::max(ratios.acceleration, std::abs(next.acceleration[i]) / guard.acceleration[i]);
    ratios.jerk = std::max(ratios.jerk, std::abs(next.acceleration[i] - previous.acceleration[i]) /
                                            dt / guard.jerk[i]);
  }
}

}  // namespace handsel::trajectory_controller
