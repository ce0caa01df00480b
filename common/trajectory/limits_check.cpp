// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/limits_check.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/trajectory/min_time.hpp"

namespace handsel {

namespace {
std::string exceeded(int axis, const char* what, double value, double limit) {
  std::ostringstream out;
  out << "axis " << axis << ": " << what << " reaches " << value << ", limit " << limit;
  return out.str();
}
}  // namespace

AxisExtremes extremes(const AxisState& start, const Segment* segments, int count) noexcept {
  AxisExtremes e{start.position, start.position, std::abs(start.velocity),
                 std::abs(start.acceleration), 0};
  AxisState s = start;
  const auto note_position = [&e](double x) {
    e.lowest = std::min(e.lowest, x);
    e.highest = std::max(e.highest, x);
  };
  for (int k = 0; k < count; ++k) {
    const double T = segments[k].duration, j = segments[k].jerk;
    e.jerk = std::max(e.jerk, std::abs(j));
    if (j != 0) {
      const double t = -s.acceleration / j;
      if (t > 0 && t < T) e.velocity = std::max(e.velocity, std::abs(advanced(s, t, j).velocity));
    }
    const double disc = s.acceleration * s.acceleration - 2 * j * s.velocity;
    if (disc >= 0) {
      const double q = -(s.acceleration + std::copysign(std::sqrt(disc), s.acceleration));
      for (const double t : {j != 0 ? q / j : -1.0, q != 0 ? 2 * s.velocity / q : -1.0}) {
        if (t > 0 && t < T) note_position(advanced(s, t, j).position);
      }
    }
    s = advanced(s, T, j);
    note_position(s.position);
    e.velocity = std::max(e.velocity, std::abs(s.velocity));
    e.acceleration = std::max(e.acceleration, std::abs(s.acceleration));
  }
  return e;
}

AxisExtremes extremes(const AxisTrajectory& axis) noexcept {
  return extremes(axis.start, axis.segments.data(), static_cast<int>(axis.segments.size()));
}

AxisExtremes rate_extremes(const AxisState& start, const Segment* segments, int count) noexcept {
  double v = start.velocity, a = start.acceleration, max_v = std::abs(v), max_a = std::abs(a),
         most_j = 0;
  for (int k = 0; k < count; ++k) {
    const double T = segments[k].duration, j = segments[k].jerk, a_next = a + T * j;
    most_j = std::max(most_j, std::abs(j));
    if (a * a_next < 0) max_v = std::max(max_v, std::abs(v - a * a / (2 * j)));
    v += T * (a + a_next) / 2;
    a = a_next;
    max_v = std::max(max_v, std::abs(v));
    max_a = std::max(max_a, std::abs(a));
  }
  return {0, 0, max_v, max_a, most_j};
}

double limit_ratio(const Trajectory& trajectory, const KinematicLimits& limits) {
  double share = 0;
  for (int i = 0; i < trajectory.size(); ++i) {
    const AxisExtremes e = extremes(trajectory.axes[i]);
    share = std::max({share, e.velocity / limits.velocity[i],
                      e.acceleration / limits.acceleration[i], e.jerk / limits.jerk[i]});
  }
  return share;
}

std::string why_bad_limits(const KinematicLimits& limits, int axes) {
  if (limits.velocity.size() != axes || limits.acceleration.size() != axes ||
      limits.jerk.size() != axes) {
    return "limits are given for " + std::to_string(limits.velocity.size()) + ", " +
           std::to_string(limits.acceleration.size()) + " and " +
           std::to_string(limits.jerk.size()) + " axes, wanted " + std::to_string(axes);
  }
  for (int i = 0; i < axes; ++i) {
    if (!(limits.velocity[i] > 0 && limits.acceleration[i] > 0 && limits.jerk[i] > 0) ||
        !std::isfinite(limits.velocity[i] + limits.acceleration[i] + limits.jerk[i])) {
      return "axis " + std::to_string(i) + ": limits must be positive and finite";
    }
  }
  return {};
}

std::string why_not_within(const Trajectory& trajectory, const KinematicLimits& limits,
                           double tol) {
  if (std::string why = why_bad_limits(limits, trajectory.size()); !why.empty()) return why;
  double first = -1;
  for (int i = 0; i < trajectory.size(); ++i) {
    const AxisTrajectory& axis = trajectory.axes[i];
    double sum = 0;
    bool usable = std::isfinite(axis.start.position) && std::isfinite(axis.start.velocity) &&
                  std::isfinite(axis.start.acceleration);
    for (const Segment& s : axis.segments) {
      usable = usable && std::isfinite(s.duration) && std::isfinite(s.jerk) && s.duration >= 0;
      sum += s.duration;
    }
    if (!usable)
      return "axis " + std::to_string(i) + ": a number is not finite or a duration is negative";
    if (first < 0) first = sum;
    if (std::abs(sum - first) > 1e-6) {
      return "axis " + std::to_string(i) + " lasts " + std::to_string(sum) + " s, axis 0 " +
             std::to_string(first) + " s";
    }
    const AxisExtremes e = extremes(axis);
    const double allowed = 1 + tol;
    if (e.velocity > limits.velocity[i] * allowed)
      return exceeded(i, "velocity", e.velocity, limits.velocity[i]);
    if (e.acceleration > limits.acceleration[i] * allowed)
      return exceeded(i, "acceleration", e.acceleration, limits.acceleration[i]);
    if (e.jerk > limits.jerk[i] * allowed) return exceeded(i, "jerk", e.jerk, limits.jerk[i]);
  }
  return {};
}

}  // namespace handsel
