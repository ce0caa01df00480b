// SPDX-License-Identifier: Apache-2.0
// Random problems of one axis, of every family that has broken a solver, and the check of a
// solution.
#pragma once

#include <cmath>
#include <ostream>
#include <random>
#include <string>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/min_time.hpp"

namespace handsel::test {

struct Case {
  AxisState from, to;
  AxisLimits limits;
};

inline std::ostream& operator<<(std::ostream& out, const Case& c) {
  out.precision(17);
  return out << "from " << c.from.position << ' ' << c.from.velocity << ' ' << c.from.acceleration
             << " to " << c.to.position << ' ' << c.to.velocity << ' ' << c.to.acceleration
             << " limits " << c.limits.velocity << ' ' << c.limits.acceleration << ' '
             << c.limits.jerk;
}

class Cases {
 public:
  static constexpr int kFamilies = 10;
  explicit Cases(std::uint64_t seed) : random_(seed) {}
  double uniform(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

  /// Any family: rest, moving, accelerating, discrete grids, V J = A^2, tiny and huge scales.
  Case next() { return next(pick(kFamilies)); }
  Case next(int family) {
    Case c;
    c.limits = {uniform(0.1, 4), uniform(0.1, 6), uniform(0.1, 12)};
    if (family == 1)
      c.limits.jerk = c.limits.acceleration * c.limits.acceleration / c.limits.velocity;
    if (family == 2) c.limits = {1.0 + pick(2), 1.0 + pick(2), 1.0 + pick(2)};
    double scale = 1;
    if (family == 3) scale = std::pow(10.0, uniform(-6, 6));
    c.limits.velocity *= scale, c.limits.acceleration *= scale, c.limits.jerk *= scale;
    c.from.position = uniform(-3, 3) * scale;
    c.to.position = uniform(-3, 3) * scale;
    if (family == 2) c.from.position = pick(3) - 1, c.to.position = pick(3) - 1;
    if (family == 4) c.to.position = c.from.position + uniform(-1, 1) * std::pow(10.0, -pick(14));
    if (family != 5) fill(c.from, c.limits, family), fill(c.to, c.limits, family);
    if (family == 6) c.to.velocity = c.to.acceleration = 0;
    if (family == 7) c.limits.velocity *= 1e6, c.limits.acceleration *= 1e6, c.limits.jerk *= 1e6;
    if (family == 9) through_zero(c);
    if (family == 8) c.from = {0.0049921875, 0, 0}, c.to = {0.005 + pick(3) * 1e-13, 0, 0};
    return c;
  }

 private:
  /// Sets accelerations of one sign whose direct motion touches zero in between, exactly or by
  /// rounding: short durations then become isolated.
  void through_zero(Case& c) {
    const double side = pick(2) ? 1 : -1, V = c.limits.velocity, A = c.limits.acceleration,
                 J = c.limits.jerk;
    const double a = std::min(A, 0.7 * std::sqrt(J * V)), from = uniform(0, 1) * a,
                 to = pick(8) ? uniform(0, 1) * a : from;
    const double gain = (from * from + to * to) / (2 * J);
    c.from.acceleration = side * from, c.to.acceleration = side * to;
    c.from.velocity = side * uniform(from * from / (2 * J) - V, V - gain - to * to / (2 * J));
    c.to.velocity = c.from.velocity + side * gain;
    if (pick(2)) c.to.velocity *= 1 + 1e-15 * (pick(5) - 2);
    const double T = (from + to) / J,
                 way = T * c.from.velocity +
                       side * (from * from * (from / 3 + to / 2) + to * to * to / 6) / (J * J);
    c.to.position =
        c.from.position + way + (pick(3) ? uniform(-1, 1) * std::pow(10.0, -pick(14)) : 0);
  }
  void fill(AxisState& s, const AxisLimits& l, int family) {
    for (;;) {
      s.velocity = uniform(-1, 1) * l.velocity;
      s.acceleration = uniform(-1, 1) * l.acceleration;
      if (family == 2) s.velocity = (pick(3) - 1), s.acceleration = (pick(3) - 1);
      if (pick(4) == 0) s.acceleration = 0;
      if (pick(6) == 0) s.velocity = 0;
      const double k = s.acceleration * std::abs(s.acceleration) / (2 * l.jerk);
      if (std::abs(s.velocity) <= l.velocity && std::abs(s.acceleration) <= l.acceleration &&
          std::abs(s.velocity + k) <= l.velocity && std::abs(s.velocity - k) <= l.velocity) {
        return;
      }
    }
  }
  std::mt19937_64 random_;
};

/// Empty, or how a motion misses its end or breaks a limit, on exact extremes.
inline std::string why_wrong(const Case& c, const AxisProfile& p, bool check_limits = true,
                             double tolerance = 1e-9) {
  AxisState s = c.from;
  for (int k = 0; k < p.count; ++k) s = advanced(s, p.segments[k].duration, p.segments[k].jerk);
  const double T = p.duration();
  const double reach = std::abs(c.from.position) + std::abs(c.to.position) + c.limits.velocity * T;
  if (std::abs(s.position - c.to.position) > tolerance * reach)
    return "ends off by " + std::to_string(s.position - c.to.position);
  if (std::abs(s.velocity - c.to.velocity) > tolerance * c.limits.velocity) return "end velocity";
  if (std::abs(s.acceleration - c.to.acceleration) > tolerance * c.limits.acceleration)
    return "end acceleration";
  if (!check_limits) return {};
  const AxisExtremes e = extremes(c.from, p.segments.data(), p.count);
  if (e.velocity > c.limits.velocity * (1 + tolerance)) return "velocity limit";
  if (e.acceleration > c.limits.acceleration * (1 + tolerance)) return "acceleration limit";
  if (e.jerk > c.limits.jerk * (1 + tolerance)) return "jerk limit";
  return {};
}

}  // namespace handsel::test
