// SPDX-License-Identifier: Apache-2.0
// Exact extremes of a trajectory and whether it keeps its limits: at segment ends and zeros of the
// acceleration, nothing sampled.
#pragma once

#include <string>

#include "common/trajectory/trajectory.hpp"

namespace handsel {

struct AxisExtremes {
  double lowest{}, highest{};                 ///< position [rad]
  double velocity{}, acceleration{}, jerk{};  ///< largest magnitudes [rad/s, rad/s^2, rad/s^3]
};

/// Returns the exact extremes over `count` segments that begin at `start`; those of `start` alone
/// when `count` is 0.
AxisExtremes extremes(const AxisState& start, const Segment* segments, int count) noexcept;
/// Returns the exact extremes over the whole axis.
AxisExtremes extremes(const AxisTrajectory&) noexcept;

/// Largest magnitudes only, positions untouched: cheaper.
AxisExtremes rate_extremes(const AxisState& start, const Segment* segments, int count) noexcept;

/// Largest of |v|/V, |a|/A, |j|/J over all axes; 1 = a limit is met.
double limit_ratio(const Trajectory&, const KinematicLimits&);

/// Empty when every axis stays within limits * (1 + tol); else one sentence naming the axis, what
/// and how much. Also refuses numbers that are not finite, negative durations, axes of different
/// durations (by more than 1e-6 s) and sizes that do not match.
std::string why_not_within(const Trajectory&, const KinematicLimits&, double tol);

/// Empty when the limits are usable for `axes` axes; else one sentence.
std::string why_bad_limits(const KinematicLimits&, int axes);

}  // namespace handsel
