// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/stop.hpp"

#include <algorithm>
#include <cmath>

namespace handsel {

void critical_movement(const AxisRates& start, const AxisRates& end, double A, double J,
                       AxisProfile& out) noexcept {
  out.clear();
  double v = start.velocity, a = start.acceleration;
  if (std::abs(a) > A) {
    const double side = a > 0 ? 1 : -1, t = (std::abs(a) - A) / J;
    out.push(t, -side * J);
    v += t * (a - side * J * t / 2);
    a = side * A;
  }
  const double a_end = std::clamp(end.acceleration, -A, A);
  const double change = end.velocity - v;
  const double direct = (a + a_end) / 2 * std::abs(a_end - a) / J;
  const double side = change >= direct ? 1.0 : -1.0;
  const double a0 = side * a, af = side * a_end, dv = side * change;
  const double square = J * dv + (a0 * a0 + af * af) / 2;
  double peak = std::sqrt(std::max(0.0, square));
  peak = std::max({peak, a0, af});
  double hold = 0;
  if (peak > A) {
    peak = A;
    hold = std::max(0.0, (square - A * A) / (J * A));
  }
  out.push((peak - a0) / J, side * J);
  out.push(hold, 0);
  out.push((peak - af) / J, -side * J);
}

StopMeasure measure_stop(double v, double a, double A, double J) noexcept {
  AxisProfile p;
  critical_movement({v, a}, {}, A, J, p);
  AxisState s{0, v, a};
  for (int k = 0; k < p.count; ++k) s = advanced(s, p.segments[k].duration, p.segments[k].jerk);
  return {p.duration(), s.position};
}

void JerkLimitedStop::init(const AxisState& state, const AxisLimits& limits) noexcept {
  state_ = segment_start_ = state;
  critical_movement({state.velocity, state.acceleration}, {}, limits.acceleration, limits.jerk,
                    profile_);
  segment_ = 0;
  elapsed_ = 0;
}

const AxisState& JerkLimitedStop::step(double dt) noexcept {
  elapsed_ += dt;
  while (segment_ < profile_.count && elapsed_ >= profile_.segments[segment_].duration) {
    const Segment& s = profile_.segments[segment_++];
    segment_start_ = advanced(segment_start_, s.duration, s.jerk);
    elapsed_ -= s.duration;
  }
  if (finished()) {
    state_ = {segment_start_.position, 0, 0};
  } else {
    state_ = advanced(segment_start_, elapsed_, profile_.segments[segment_].jerk);
  }
  return state_;
}

double JerkLimitedStop::remaining() const noexcept {
  double sum = -elapsed_;
  for (int k = segment_; k < profile_.count; ++k) sum += profile_.segments[k].duration;
  return finished() ? 0 : sum;
}

Trajectory stop_trajectory(const MotionState3& state, const KinematicLimits& limits) {
  Trajectory out;
  for (Eigen::Index i = 0; i < state.position.size(); ++i) {
    AxisProfile p;
    critical_movement({state.velocity[i], state.acceleration[i]}, {}, limits.acceleration[i],
                      limits.jerk[i], p);
    out.axes.push_back({{state.position[i], state.velocity[i], state.acceleration[i]},
                        {p.segments.begin(), p.segments.begin() + p.count}});
  }
  const double max_duration = out.duration();
  for (AxisTrajectory& axis : out.axes) {
    double sum = 0;
    for (const Segment& s : axis.segments) sum += s.duration;
    if (sum < max_duration) axis.segments.push_back({max_duration - sum, 0});
  }
  return out;
}

}  // namespace handsel
