// The trajectory model (chapter section 4.2.1): n axes, each a series of cubic segments (duration, jerk) from an initial state.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace handsel {

/// Symmetric bounds per axis (chapter eq. 9): [rad/s, rad/s^2, rad/s^3] (m for prismatic axes). All > 0.
struct KinematicLimits {
  Eigen::VectorXd velocity, acceleration, jerk;
};

/// Kinematic state of several axes.
struct MotionState3 {
  Eigen::VectorXd position, velocity, acceleration;
};

struct AxisState {
  double position{}, velocity{}, acceleration{};
};

/// A cubic piece: constant jerk for a duration (chapter eq. 2).
struct Segment {
  double duration{};  ///< [s], >= 0
  double jerk{};
};

/// One axis: where it starts and its segments (chapter eq. 3, 6-8).
struct AxisTrajectory {
  AxisState start;
  std::vector<Segment> segments;
};

/// All axes last equally long. An empty trajectory (no axes) lasts 0.
struct Trajectory {
  std::vector<AxisTrajectory> axes;

  double duration() const;  ///< [s]
  int size() const { return static_cast<int>(axes.size()); }
  /// State at time t, clamped to [0, duration]. `out` must have size() entries; allocates nothing.
  void sample(double t, MotionState3& out) const noexcept;
  MotionState3 at(double t) const;  ///< allocating convenience
};

}  // namespace handsel
