// SPDX-License-Identifier: Apache-2.0
// Smooths an input inside the limits, each tick (chapter section 4.3.4): toward a velocity and
// acceleration by the critical movement, toward a moving target by the minimum-time motion ("track
// and catch an object held by the human"). One axis; no allocation.
#pragma once

#include "common/trajectory/min_time.hpp"

namespace handsel {

class SetpointFilter {
 public:
  SetpointFilter() = default;
  SetpointFilter(const AxisState& state, const AxisLimits& limits) noexcept
      : state_(state), limits_(limits) {}

  /// One tick toward a velocity and acceleration (clamped to the limits; not finite: 0).
  const AxisState& toward_velocity(double velocity, double acceleration, double dt) noexcept;
  /// One tick toward a target, as it is now, that continues with its velocity and acceleration:
  /// minimum time in the frame that moves with it, so at its rest, and an acceleration of the
  /// target asked for anew each tick makes no difference in kind. Its acceleration counts up to
  /// half the limit. Once caught, a target of constant acceleration is followed without error.
  const AxisState& toward(const AxisState& target, double dt) noexcept;

  /// Returns the state after the last tick, at first the one given at construction.
  const AxisState& state() const noexcept { return state_; }
  double jerk() const noexcept { return jerk_; }  ///< largest magnitude in the last tick [rad/s^3]

 private:
  void follow(const AxisProfile& profile, double dt) noexcept;
  AxisState state_;
  AxisLimits limits_{1, 1, 1};
  double jerk_{};
};

}  // namespace handsel
