// SPDX-License-Identifier: Apache-2.0
// One axis from wherever it is to a target in minimum time, changeable and stoppable at any moment.
// No heap, noexcept.
#pragma once

#include "common/trajectory/min_time.hpp"

namespace handsel::trajectory_controller {

class AxisMover {
 public:
  /// Starts at rest at `position` [rad or m].
  void reset(double position) noexcept;
  /// Starts in motion at `state` and stops in minimum time.
  void take_over(const AxisState& state, const AxisLimits& limits) noexcept;
  /// Plans a minimum-time motion from the present state to rest at `target`. If the present
  /// acceleration would carry the velocity beyond that of `limits`, acceleration and jerk of
  /// `fallback_limits` are used to prevent that.
  void go_to(double target, const AxisLimits& limits, const AxisLimits& fallback_limits) noexcept;
  /// Plans a minimum-time stop from the present state.
  void stop(const AxisLimits& limits) noexcept;
  /// Returns the state `dt` [s] later.
  const AxisState& step(double dt) noexcept;

  /// State after the last step(), reset() or take_over().
  const AxisState& state() const noexcept { return state_; }
  double target() const noexcept { return target_; }  ///< where it comes to rest
  /// Returns whether the motion has ended; false at the zero velocity of a
  /// reversal.
  bool at_rest() const noexcept { return segment_ >= profile_.count; }

 private:
  void begin() noexcept;

  AxisProfile profile_;
  AxisState state_, segment_start_;
  double target_{}, elapsed_{};
  int segment_{};
};

}  // namespace handsel::trajectory_controller
