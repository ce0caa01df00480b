// SPDX-License-Identifier: Apache-2.0
// Minimum-time stop of one axis: velocity and acceleration to zero, position free (the critical
// movement, chapter section 4.3.4).
#pragma once

#include "common/trajectory/min_time.hpp"

namespace handsel {

/// Velocity and acceleration of one axis where its position does not matter.
struct AxisRates {
  double velocity{}, acceleration{};  ///< [rad/s], [rad/s^2]
};

/// Computes the fastest change from `start` to `end`, position free: at most three segments, four
/// when |acceleration| starts beyond the limit. The velocity goes beyond both ends only where the
/// start acceleration makes it. Never fails for finite numbers and positive limits.
void critical_movement(const AxisRates& start, const AxisRates& end, double max_acceleration,
                       double max_jerk, AxisProfile& out) noexcept;

/// Time and distance of the minimum-time stop.
struct StopMeasure {
  double duration{};  ///< [s]
  double distance{};  ///< signed [rad]
};
/// Returns duration and distance of the stop from this velocity and acceleration by
/// critical_movement().
StopMeasure measure_stop(double velocity, double acceleration, double max_acceleration,
                         double max_jerk) noexcept;

/// A stop in progress, for a cycle: no allocation.
class JerkLimitedStop {
 public:
  /// Starts a stop from a state, whose velocity may exceed the limits; limits.velocity is not used.
  void init(const AxisState& state, const AxisLimits& limits) noexcept;
  const AxisState& step(double dt) noexcept;  ///< state dt later
  /// Returns the state after the last step(); its velocity and acceleration are 0 once finished.
  const AxisState& state() const noexcept { return state_; }
  /// Returns whether the axis is at rest; true before init().
  bool finished() const noexcept { return segment_ >= profile_.count; }
  double remaining() const noexcept;  ///< [s]

 private:
  AxisProfile profile_;
  AxisState state_, segment_start_;
  int segment_{};
  double elapsed_{};
};

/// Every axis stops by itself as fast as it can; the trajectory lasts as long as the slowest.
Trajectory stop_trajectory(const MotionState3& state, const KinematicLimits& limits);

}  // namespace handsel
