// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/path_segment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handsel::detail {
namespace {

constexpr double kKept =
    1 -
    1e-9;  // fraction of a distance, so that the change of velocity stays possible despite rounding

/// Returns the distance of a change of velocity with acceleration 0 at both ends.
double change_distance(double from, double to, const AxisLimits& limits) noexcept {
  const double change = std::abs(to - from);
  const double lasts = change * limits.jerk >= limits.acceleration * limits.acceleration
                           ? change / limits.acceleration + limits.acceleration / limits.jerk
                           : 2 * std::sqrt(change / limits.jerk);
  return 0.5 * (from + to) * lasts;
}

/// Returns the max velocity, at most `max_velocity`, reachable from `from` within a
/// distance.
double reached_within(double from, double max_velocity, double distance,
                      const AxisLimits& limits) noexcept {
  if (max_velocity <= from || change_distance(from, max_velocity, limits) <= distance)
    return max_velocity;
  double low = from, high = max_velocity;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (change_distance(from, middle, limits) <= distance ? low : high) = middle;
  }
  return low;
}

AxisLimits scaled(const AxisLimits& limits, const LimitScale& scale) noexcept {
  return {limits.velocity * scale.velocity, limits.acceleration * scale.acceleration,
          limits.jerk * scale.jerk};
}

}  // namespace

PathSegment::PathSegment(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                         const KinematicLimits& limits, const LimitZones& speeds)
    : from(a), step(b - a) {
  AxisLimits l{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
               std::numeric_limits<double>::max()};
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const double d = std::abs(step[i]);
    if (d == 0) continue;
    l.velocity = std::min(l.velocity, limits.velocity[i] / d);
    l.acceleration = std::min(l.acceleration, limits.acceleration[i] / d);
    l.jerk = std::min(l.jerk, limits.jerk[i] / d);
  }
  LimitScale min_scale;
  for (const LimitZone& zone : speeds) min_scale = min_scale.lower(zone.scale);
  const AxisLimits lowest = scaled(l, min_scale);
  if (!zoned(speeds, l) || duration > rest_to_rest_time(1, lowest)) {
    knots.clear();
    zones.clear();
    duration = 0;
    if (min_scale != LimitScale{}) zones.push_back({0, min_scale});
    AxisProfile profile;
    solve_axis({0, 0, 0}, {1, 0, 0}, lowest, profile);
    knots.reserve(static_cast<std::size_t>(profile.count));
    add(profile);
  }
  slowing = starting = duration / 2;
  bool first = true;
  for (const Knot& knot : knots) {
    if (knot.segment.jerk != 0 || !(std::abs(knot.state.acceleration) < 1e-9 * l.acceleration))
      continue;
    if (first) starting = knot.time;
    first = false;
    slowing = duration - knot.time - knot.segment.duration;
  }
}

/// Computes the fastest motion in each zone between the velocities at its ends; there the
/// acceleration is 0, and the velocity is the max that both zones allow and that can be left again.
bool PathSegment::zoned(const LimitZones& speeds, const AxisLimits& limits) {
  std::vector<LimitZone> left;
  double begin = 0;
  for (const LimitZone& zone : speeds) {
    if (!(zone.end > begin)) continue;
    if (!left.empty() && left.back().scale == zone.scale)
      left.back().end = zone.end;
    else
      left.push_back(zone);
    begin = zone.end;
  }
  if (left.size() < 2) return false;
  left.back().end = 1;
  const std::size_t n = left.size();
  std::vector<double> length(n), velocity(n + 1, 0.0);
  std::vector<AxisLimits> here;
  for (std::size_t k = 0; k < n; ++k) {
    length[k] = left[k].end - (k > 0 ? left[k - 1].end : 0.0);
    here.push_back(scaled(limits, left[k].scale));
    if (k > 0) velocity[k] = std::min(here[k - 1].velocity, here[k].velocity);
  }
  for (std::size_t k = 1; k < n; ++k)
    velocity[k] = reached_within(velocity[k - 1], velocity[k], kKept * length[k - 1], here[k - 1]);
  for (std::size_t k = n - 1; k > 0; --k)
    velocity[k] = reached_within(velocity[k + 1], velocity[k], kKept * length[k], here[k]);
  AxisProfile profile;
  for (std::size_t k = 0; k < n; ++k) {
    if (solve_axis({0, velocity[k], 0}, {length[k], velocity[k + 1], 0}, here[k], profile) !=
        AxisOutcome::ok)
      return false;
    zones.push_back({duration, left[k].scale});
    add(profile);
  }
  return true;
}

void PathSegment::add(const AxisProfile& profile) {
  AxisState s;
  if (!knots.empty()) {
    const Knot& last = knots.back();
    s = advanced(last.state, last.segment.duration, last.segment.jerk);
  }
  for (int k = 0; k < profile.count; ++k) {
    knots.push_back({s, duration, profile.segments[k]});
    s = advanced(s, profile.segments[k].duration, profile.segments[k].jerk);
    duration += profile.segments[k].duration;
  }
}

AxisState PathSegment::path_state(double t) const noexcept {
  std::size_t k = 0;
  while (k + 1 < knots.size() && t >= knots[k + 1].time) ++k;
  return advanced(knots[k].state, std::clamp(t - knots[k].time, 0.0, knots[k].segment.duration),
                  knots[k].segment.jerk);
}

void PathSegment::part(double begin, double end, AxisProfile& out) const noexcept {
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const double ends = k + 1 < knots.size() ? knots[k + 1].time : duration;
    out.push(std::min(end, ends) - std::max(begin, knots[k].time), knots[k].segment.jerk);
  }
}

LimitScale PathSegment::scale(double begin, double end) const noexcept {
  LimitScale min_scale;
  for (std::size_t k = 0; k < zones.size(); ++k) {
    const double ends = k + 1 < zones.size() ? zones[k + 1].begin : duration;
    if (zones[k].begin <= end && begin <= ends) min_scale = min_scale.lower(zones[k].scale);
  }
  return min_scale;
}

}  // namespace handsel::detail
