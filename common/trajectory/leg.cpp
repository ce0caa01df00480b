#include "common/trajectory/leg.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handsel::detail {

Leg::Leg(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const KinematicLimits& limits) : from(a), step(b - a) {
  AxisLimits l{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const double d = std::abs(step[i]);
    if (d == 0) continue;
    l.velocity = std::min(l.velocity, limits.velocity[i] / d);
    l.acceleration = std::min(l.acceleration, limits.acceleration[i] / d);
    l.jerk = std::min(l.jerk, limits.jerk[i] / d);
  }
  solve_axis({0, 0, 0}, {1, 0, 0}, l, profile);
  AxisState s;
  for (int k = 0; k < profile.count; ++k) {
    at[k] = s;
    knot[k] = duration;
    s = advanced(s, profile.segments[k].duration, profile.segments[k].jerk);
    duration += profile.segments[k].duration;
  }
  at[profile.count] = s;
  knot[profile.count] = duration;
  slowing = duration / 2;
  for (int k = 0; k < profile.count; ++k) {
    if (profile.segments[k].jerk == 0 && std::abs(at[k].acceleration) < 1e-9 * l.acceleration) slowing = knot[k];
  }
}

AxisState Leg::path_state(double t) const noexcept {
  int k = 0;
  while (k + 1 < profile.count && t >= knot[k + 1]) ++k;
  return advanced(at[k], std::clamp(t - knot[k], 0.0, profile.segments[k].duration), profile.segments[k].jerk);
}

void Leg::part(double begin, double end, AxisProfile& out) const noexcept {
  for (int k = 0; k < profile.count; ++k) out.push(std::min(end, knot[k + 1]) - std::max(begin, knot[k]), profile.segments[k].jerk);
}

}  // namespace handsel::detail
