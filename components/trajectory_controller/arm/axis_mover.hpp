// One axis from wherever it is to a target in minimum time, changeable and stoppable at any moment.
// No heap, noexcept.
#pragma once

#include "common/trajectory/min_time.hpp"

namespace handsel::trajectory_controller {

class AxisMover {
 public:
  /// At rest at `position`.
  void reset(double position) noexcept;
  /// In motion at `state`; comes to rest as fast as it can.
  void take_over(const AxisState& state, const AxisLimits& limits) noexcept;
  /// Minimum-time motion from the present state to rest at `target`. Where `limits` would let the
  /// present state continue to a velocity beyond theirs, acceleration and jerk may be as large as
  /// `max_velocity`.
  void go_to(double target, const AxisLimits& limits, const AxisLimits& max_velocity) noexcept;
  /// Minimum-time stop from the present state.
  void stop(const AxisLimits& limits) noexcept;
  const AxisState& step(double dt) noexcept;  ///< state dt later

  /// State after the last step() or take-over.
  const AxisState& state() const noexcept { return state_; }
  double target() const noexcept { return target_; }  ///< where it comes to rest
  /// Returns whether the motion has ended; false while it stands for a moment in between.
  bool at_rest() const noexcept { return segment_ >= profile_.count; }

 private:
  void begin() noexcept;

  AxisProfile profile_;
  AxisState state_, segment_start_;
  double target_{}, elapsed_{};
  int segment_{};
};

}  // namespace handsel::trajectory_controller
