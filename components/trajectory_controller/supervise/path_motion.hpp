// SPDX-License-Identifier: Apache-2.0
// Motion along a path at full speed, and what it takes to stop it at a fraction of that speed.
// Pure, no heap.
#pragma once

#include <array>
#include <vector>

#include "common/model/robot_capsules.hpp"
#include "common/trajectory/trajectory.hpp"
#include "components/trajectory_controller/supervise/link_motion.hpp"

namespace handsel::trajectory_controller {

/// Motion along the running trajectory at full speed: of each axis, and of the links.
struct PathMotion {
  const Eigen::VectorXd* velocity{};       ///< q' all axes [rad/s]
  const Eigen::VectorXd* acceleration{};   ///< q'' all axes [rad/s^2]
  const std::vector<Pose>* links{};        ///< T_root_link
  const std::vector<LinkTwist>* twists{};  ///< of the links at q', root axes
};

/// Returns the time of the jerk-limited stop of one axis from velocity v (a = 0) [s]; its travel is
/// v times half of that.
double stop_time(double v, double acceleration_limit, double jerk_limit) noexcept;

/// Number of steps of the speed factors in a StopTable.
inline constexpr int kStopGrid = 16;

/// Stop of the axes that move along the path, for the speed factors k / kStopGrid.
struct StopTable {
  std::array<double, kStopGrid + 1> time{};  ///< until all axes rest [s]
  std::array<double, kStopGrid + 1>
      distance{};  ///< travel divided by speed, largest of all axes [s]
};
/// Returns times and travels of the stops from the motion at each factor, every axis jerk-limited
/// by itself; 0 at factor 0.
StopTable stop_table(const PathMotion& motion, const KinematicLimits& stop_limits) noexcept;

/// A link's capsule in the world with the velocities of its ends at full speed.
struct MovingCapsule {
  Vector3 a, b;    ///< [m]
  Vector3 va, vb;  ///< [m/s]
  double radius;   ///< [m]
};
/// Returns the capsule of a link at the pose and speed of `motion`.
MovingCapsule placed(const LinkCapsule& link, const PathMotion& motion,
                     const Pose& T_world_base) noexcept;

}  // namespace handsel::trajectory_controller
