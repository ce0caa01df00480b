// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/setpoint_filter.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/stop.hpp"

namespace handsel {

namespace {
double usable(double x, double bound) noexcept {
  return std::isfinite(x) ? std::clamp(x, -bound, bound) : 0.0;
}

/// Returns the acceleration that can be held for a tick at this velocity without exceeding the
/// velocity limit, before or after.
double reachable_acceleration(double velocity, double acceleration, const AxisLimits& l,
                              double dt) noexcept {
  const double room = std::max(0.0, l.velocity - std::abs(velocity) - l.acceleration * dt);
  return usable(acceleration, std::min(l.acceleration, std::sqrt(2 * l.jerk * room)));
}
}  // namespace

void SetpointFilter::follow(const AxisProfile& profile, double dt) noexcept {
  jerk_ = 0;
  for (int k = 0; k < profile.count && dt > 0; ++k) {
    const double step = std::min(dt, profile.segments[k].duration);
    jerk_ = std::max(jerk_, std::abs(profile.segments[k].jerk));
    state_ = advanced(state_, step, profile.segments[k].jerk);
    dt -= step;
  }
  if (dt > 0) state_ = advanced(state_, dt, 0);
}

const AxisState& SetpointFilter::toward_velocity(double velocity, double acceleration,
                                                 double dt) noexcept {
  velocity = usable(velocity, limits_.velocity);
  acceleration = reachable_acceleration(velocity, acceleration, limits_, dt);
  AxisProfile profile;
  critical_movement({state_.velocity, state_.acceleration}, {velocity, acceleration},
                    limits_.acceleration, limits_.jerk, profile);
  follow(profile, dt);
  return state_;
}

const AxisState& SetpointFilter::toward(const AxisState& target, double dt) noexcept {
  const double carried = usable(target.velocity, limits_.velocity);
  const double pushed = usable(target.acceleration, limits_.acceleration / 2);
  const AxisLimits left{limits_.velocity - std::abs(carried),
                        limits_.acceleration - std::abs(pushed), limits_.jerk};
  const AxisState relative{state_.position - target.position, state_.velocity - carried,
                           state_.acceleration - pushed};
  AxisProfile profile;
  if (!(left.velocity > 1e-9 * limits_.velocity) ||
      solve_axis(relative, {}, left, profile) != AxisOutcome::ok) {
    return toward_velocity(carried, 0, dt);
  }
  const AxisState before = state_;
  follow(profile, dt);
  const double rest =
      state_.velocity + state_.acceleration * std::abs(state_.acceleration) / (2 * limits_.jerk);
  const double bound = limits_.velocity * (1 + 1e-9), push = limits_.acceleration * (1 + 1e-9);
  if (std::abs(state_.velocity) > bound || std::abs(rest) > bound ||
      std::abs(state_.acceleration) > push) {
    state_ = before;
    return toward_velocity(carried, 0, dt);
  }
  return state_;
}

}  // namespace handsel
