// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop_deadline.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

void StopDeadline::set_free(const MotionState3& set_point, TimePoint now) noexcept {
  rest_due_ = now + from_seconds(fastest_stop(set_point));
}

bool StopDeadline::is_due(const MotionState3& set_point, double slack,
                          TimePoint now) const noexcept {
  const double needed = fastest_stop_after_a_cycle(set_point) + 3 * period_;
  return now + from_seconds(needed) >= rest_due_ + from_seconds(slack);
}

double StopDeadline::ease(const MotionState3& set_point) const noexcept {
  double max_ease = 0.0;
  for (int axis : axes_) {
    const double direction = std::copysign(1.0, set_point.velocity[axis]);
    const double onward = direction * set_point.acceleration[axis];
    max_ease = std::max(max_ease, onward / robot_.stop_limits().jerk[axis]);
  }
  return max_ease;
}

double StopDeadline::fastest_stop(int axis, double velocity, double acceleration) const noexcept {
  const KinematicLimits& limits = robot_.stop_limits();
  const double max_acceleration = limits.acceleration[axis], max_jerk = limits.jerk[axis];
  return measure_stop(velocity, acceleration, max_acceleration, max_jerk).duration;
}

/// Returns the duration of the fastest stop of the arm, each axis by itself [s].
double StopDeadline::fastest_stop(const MotionState3& set_point) const noexcept {
  double max_time = 0.0;
  for (int axis : axes_) {
    const double velocity = set_point.velocity[axis];
    max_time = std::max(max_time, fastest_stop(axis, velocity, set_point.acceleration[axis]));
  }
  return max_time;
}

/// Returns the max duration of the fastest stop after any possible next cycle [s]. For an axis that
/// brakes almost too hard to stop without overshoot it is much longer one cycle later.
double StopDeadline::fastest_stop_after_a_cycle(const MotionState3& set_point) const noexcept {
  const double dt = period_;
  double max_time = 0.0;
  for (int axis : axes_) {
    const double max_jerk = robot_.stop_limits().jerk[axis];
    for (const double j : {-max_jerk, max_jerk}) {
      const double a = set_point.acceleration[axis];
      const double velocity = set_point.velocity[axis] + a * dt + 0.5 * j * dt * dt;
      max_time = std::max(max_time, fastest_stop(axis, velocity, a + j * dt));
    }
  }
  return max_time;
}

}  // namespace handsel::trajectory_controller
