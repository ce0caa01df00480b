// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/axis_mover.hpp"

#include <cmath>

#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

void AxisMover::reset(double position) noexcept {
  state_ = {position, 0.0, 0.0};
  profile_.clear();
  target_ = position;
  begin();
}

void AxisMover::take_over(const AxisState& state, const AxisLimits& limits) noexcept {
  state_ = state;
  stop(limits);
}

void AxisMover::begin() noexcept {
  segment_start_ = state_;
  elapsed_ = 0.0;
  segment_ = 0;
}

void AxisMover::go_to(double target, const AxisLimits& limits,
                      const AxisLimits& fallback_limits) noexcept {
  AxisLimits used = limits;
  if (std::abs(state_.velocity + state_.acceleration * std::abs(state_.acceleration) /
                                     (2.0 * limits.jerk)) > limits.velocity) {
    used.acceleration = fallback_limits.acceleration;
    used.jerk = fallback_limits.jerk;
  }
  AxisProfile profile;
  if (solve_axis(state_, {target, 0.0, 0.0}, used, profile) != AxisOutcome::ok) {
    stop(fallback_limits);
    return;
  }
  profile_ = profile;
  target_ = target;
  begin();
}

void AxisMover::stop(const AxisLimits& limits) noexcept {
  if (state_.velocity == 0.0 && state_.acceleration == 0.0) {
    reset(state_.position);
    return;
  }
  critical_movement({state_.velocity, state_.acceleration}, {}, limits.acceleration, limits.jerk,
                    profile_);
  begin();
  AxisState end = state_;
  for (int k = 0; k < profile_.count; ++k)
    end = advanced(end, profile_.segments[static_cast<std::size_t>(k)].duration,
                   profile_.segments[static_cast<std::size_t>(k)].jerk);
  target_ = end.position;
}

const AxisState& AxisMover::step(double dt) noexcept {
  elapsed_ += dt;
  while (!at_rest() && elapsed_ >= profile_.segments[static_cast<std::size_t>(segment_)].duration) {
    const Segment& s = profile_.segments[static_cast<std::size_t>(segment_++)];
    segment_start_ = advanced(segment_start_, s.duration, s.jerk);
    elapsed_ -= s.duration;
  }
  state_ = at_rest() ? AxisState{target_, 0.0, 0.0}
                     : advanced(segment_start_, elapsed_,
                                profile_.segments[static_cast<std::size_t>(segment_)].jerk);
  return state_;
}

}  // namespace handsel::trajectory_controller
