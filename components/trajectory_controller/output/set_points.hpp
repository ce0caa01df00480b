// SPDX-License-Identifier: Apache-2.0
// The set-point of all axes sent last, and the next one while it is made. Pure, no heap after
// construction.
#pragma once

#include <algorithm>
#include <vector>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/min_time.hpp"
#include "components/trajectory_controller/output/setpoint_check.hpp"

namespace handsel::trajectory_controller {

class SetPoints {
 public:
  /// At rest with all `dof` axes at 0.
  explicit SetPoints(int dof) : sent_(rest_state(Eigen::VectorXd::Zero(dof))), next_(sent_) {}

  /// Begins anew at rest at `position`, all axes [rad, m].
  void restart(const Eigen::VectorXd& position) { next_ = sent_ = rest_state(position); }
  /// Begins a cycle: what is sent next is what was sent last, until it is changed.
  void begin_cycle() { next_ = sent_; }
  /// Ends a cycle: what was made is what was sent. `guard`: limits; `dt`: control period [s].
  void end_cycle(const KinematicLimits& guard, double dt) noexcept {
    measure(sent_, next_, guard, dt, ratios_);
    sent_ = next_;
  }

  /// Set-point sent last, all axes.
  const MotionState3& sent() const noexcept { return sent_; }
  /// Set-point to be sent next, all axes.
  const MotionState3& next() const noexcept { return next_; }
  /// The same, to be changed.
  MotionState3& next() noexcept { return next_; }
  /// Largest ratios to the guard limits so far.
  const LimitRatios& ratios() const noexcept { return ratios_; }

  /// Returns whether no axis moved in the set-point sent last.
  bool at_rest() const noexcept {
    return sent_.velocity.isZero(0.0) && sent_.acceleration.isZero(0.0);
  }
  /// Returns whether an axis moves in the next set-point.
  bool moves(int axis) const noexcept {
    return next_.velocity[axis] != 0.0 || next_.acceleration[axis] != 0.0;
  }
  /// Returns whether any of the axes moves in the next set-point.
  bool any_moves(const std::vector<int>& axes) const noexcept {
    return std::any_of(axes.begin(), axes.end(), [&](int axis) { return moves(axis); });
  }

 private:
  MotionState3 sent_, next_;
  LimitRatios ratios_;
};

}  // namespace handsel::trajectory_controller
