// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/stop_plan.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kRounding = 1e-9;    // [rad, m]
constexpr double kBoundSlack = 1e-6;  // max excess of trajectories over a bound [rad, m]

}  // namespace

AxisState AxisStop::at(double t) const noexcept {
  if (t < delay) return advanced(start, t, 0.0);
  AxisState s = advanced(start, delay, 0.0);
  t -= delay;
  for (int k = 0; k < profile.count; ++k) {
    const Segment& segment = profile.segments[static_cast<std::size_t>(k)];
    if (t < segment.duration) return advanced(s, t, segment.jerk);
    s = advanced(s, segment.duration, segment.jerk);
    t -= segment.duration;
  }
  return {s.position, 0.0, 0.0};
}

/// Returns the max speed. Within a segment of constant jerk it occurs at an end or where the
/// acceleration changes its sign.
double AxisStop::max_speed_between(double from, double to) const noexcept {
  double fastest = 0.0, begin = 0.0;
  AxisState s = start;
  const auto add = [&](double length, double jerk) {
    const double first = std::clamp(from - begin, 0.0, length);
    const double last = std::clamp(to - begin, 0.0, length);
    const auto speed_at = [&](double t) { return std::abs(advanced(s, t, jerk).velocity); };
    if (first < last) {
      fastest = std::max({fastest, speed_at(first), speed_at(last)});
      const double turn = jerk == 0.0 ? -1.0 : -s.acceleration / jerk;
      if (turn > first && turn < last) fastest = std::max(fastest, speed_at(turn));
    }
    s = advanced(s, length, jerk);
    begin += length;
  };
  if (delay > 0.0) add(delay, 0.0);
  for (int k = 0; k < profile.count; ++k) {
    const Segment& segment = profile.segments[static_cast<std::size_t>(k)];
    add(segment.duration, segment.jerk);
  }
  return fastest;
}

StopPlan::StopPlan(const RobotModel& robot, const std::vector<char>& sliding)
    : limits_(robot.stop_limits()), sliding_(sliding) {
  for (const Axis& axis : robot.axes()) {
    lower_.push_back(axis.lower);
    upper_.push_back(axis.upper);
  }
}

void StopPlan::position_at(double time, Vector& position) const noexcept {
  for (int k = 0; k < count_; ++k) {
    const AxisStop& axis = (*this)[k];
    position[axis.axis] = axis.at(time).position;
  }
}

void StopPlan::plan(const MotionState3& state, double delay) noexcept {
  count_ = 0;
  inside_ = true;
  duration_ = 0.0;
  const int dof = std::min<int>(static_cast<int>(state.position.size()), kMaxAxes);
  for (int i = 0; i < dof; ++i) {
    if (state.velocity[i] == 0.0 && state.acceleration[i] == 0.0) continue;
    AxisStop& axis = axes_[static_cast<std::size_t>(count_++)];
    axis.axis = i;
    axis.sliding = sliding_[static_cast<std::size_t>(i)];
    axis.start = {state.position[i], state.velocity[i], state.acceleration[i]};
    axis.delay = delay;
    AxisState s = advanced(axis.start, delay, 0.0);
    // Upper bound: within a segment of constant jerk the max speed occurs at an end, or exceeds the
    // speed there by less than |a| t / 2.
    axis.max_speed = std::max(std::abs(axis.start.velocity), std::abs(s.velocity));
    axis.travel = axis.max_speed * delay;
    critical_movement({s.velocity, s.acceleration}, {}, limits_.acceleration[i], limits_.jerk[i],
                      axis.profile);
    axis.duration = delay;
    for (int k = 0; k < axis.profile.count; ++k) {
      const Segment& segment = axis.profile.segments[static_cast<std::size_t>(k)];
      const AxisState next = advanced(s, segment.duration, segment.jerk);
      double fastest = std::max(std::abs(s.velocity), std::abs(next.velocity));
      if (s.acceleration * next.acceleration < 0.0)
        fastest = std::max(
            fastest, std::abs(s.velocity - 0.5 * s.acceleration * s.acceleration / segment.jerk));
      axis.max_speed = std::max(axis.max_speed, fastest);
      axis.travel += fastest * segment.duration;
      axis.duration += segment.duration;
      s = next;
    }
    duration_ = std::max(duration_, axis.duration);
    inside_ = inside_ && ends_inside(i, axis.start.position, s.position);
  }
}

/// Returns whether an axis that is inside its bounds comes to rest inside them.
bool StopPlan::ends_inside(int axis, double start, double end) const noexcept {
  const double low = lower_[static_cast<std::size_t>(axis)];
  const double high = upper_[static_cast<std::size_t>(axis)];
  if (!(low < high) || start < low - kBoundSlack || start > high + kBoundSlack) return true;
  return end >= low - kBoundSlack - kRounding && end <= high + kBoundSlack + kRounding;
}

}  // namespace handsel::trajectory_controller
