// SPDX-License-Identifier: Apache-2.0
// The trajectory model (chapter section 4.2.1): n axes, each a series of cubic segments (duration,
// jerk) from an initial state.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace handsel {

/// Symmetric bounds of each axis (chapter eq. 9); m instead of rad for prismatic axes.
struct KinematicLimits {
  Eigen::VectorXd velocity, acceleration, jerk;  ///< [rad/s], [rad/s^2], [rad/s^3], all > 0
};

/// Kinematic state of several axes; m instead of rad for prismatic axes.
struct MotionState3 {
  Eigen::VectorXd position, velocity, acceleration;  ///< [rad], [rad/s], [rad/s^2]
};

/// Kinematic state of one axis; m instead of rad for a prismatic axis.
struct AxisState {
  double position{}, velocity{}, acceleration{};  ///< [rad], [rad/s], [rad/s^2]
};

/// A cubic piece: constant jerk for a duration (chapter eq. 2).
struct Segment {
  double duration{};  ///< [s], >= 0
  double jerk{};      ///< [rad/s^3]
};

/// One axis: where it starts and its segments (chapter eq. 3, 6-8).
struct AxisTrajectory {
  AxisState start;                ///< state at time 0
  std::vector<Segment> segments;  ///< in order of time; empty: the axis lasts 0 s
};

/// All axes last equally long. An empty trajectory (no axes) lasts 0.
struct Trajectory {
  std::vector<AxisTrajectory> axes;  ///< in the order of the axes of the robot or group

  double duration() const;  ///< [s]
  /// Returns the number of axes.
  int size() const { return static_cast<int>(axes.size()); }
  /// State at time t, clamped to [0, duration]. `out` must have size() entries; allocates nothing.
  void sample(double t, MotionState3& out) const noexcept;
  MotionState3 at(double t) const;  ///< as sample(), in a new state; allocates
};

}  // namespace handsel
