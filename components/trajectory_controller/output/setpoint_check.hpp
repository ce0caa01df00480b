// SPDX-License-Identifier: Apache-2.0
// The last check of a set-point before it is sent: finite, inside the guard limits, continuous with
// the one before, and still stoppable inside the limits. Own method. Pure, no heap.
#pragma once

#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_controller {

/// Relative tolerance on every limit.
inline constexpr double kLimitTolerance = 1e-6;

/// Largest |v|/V, |a|/A, |j|/J sent so far.
struct LimitRatios {
  double velocity{}, acceleration{}, jerk{};  ///< largest ratio over all axes; 1: at the limit
};

/// Whether axis `i` may go from `previous` to `next` within `dt` [s].
bool acceptable(const MotionState3& previous, const MotionState3& next, Eigen::Index i,
                const KinematicLimits& guard, double dt) noexcept;

/// Raises the ratios by those of the step from `previous` to `next`, which takes `dt` [s].
void measure(const MotionState3& previous, const MotionState3& next, const KinematicLimits& guard,
             double dt, LimitRatios& ratios) noexcept;

}  // namespace handsel::trajectory_controller
