// SPDX-License-Identifier: Apache-2.0
// An independent, slow minimum-time solver for one axis: scans every family of bang-bang profiles
// for all roots, without assumptions on monotonicity or the sign of the motion. For tests only.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/trajectory/min_time.hpp"

namespace handsel::test {

struct SlowProfile {
  std::vector<Segment> segments;
  bool valid{};
  double duration() const {
    double t = 0;
    for (const Segment& s : segments) t += s.duration;
    return t;
  }
};

/// +J to a1, hold, -J to a2, hold, +J to af; velocity end met by the caller's choice.
inline AxisState run(AxisState s, const std::vector<Segment>& segments) {
  for (const Segment& g : segments) s = advanced(s, g.duration, g.jerk);
  return s;
}

/// From (v, a) to (peak, 0), rising lobe; invalid if it does not exist.
inline bool rising(double v, double a, double peak, double A, double J, std::vector<Segment>& out) {
  const double R = J * (peak - v) + a * a / 2;
  if (R < -1e-14 * (J * (std::abs(peak) + std::abs(v)) + a * a)) return false;
  double a1 = std::sqrt(std::max(0.0, R)), hold = 0;
  if (a1 > A) {
    a1 = A;
    hold = (peak - v - (2 * A * A - a * a) / (2 * J)) / A;
  }
  const double slop = 1e-9 * (A + std::abs(a));
  if (a1 - a < -slop || hold < 0) return false;
  out = {{std::max(0.0, a1 - a) / J, J}, {hold, 0}, {a1 / J, -J}};
  return true;
}

/// Returns the durations at which the wanted displacement is the max or min possible, ascending:
/// the min duration first, then the bounds of the blocked intervals. Pairs between two points of
/// the coarse grid are missing.
inline std::vector<double> slow_bounds(const AxisState& from, const AxisState& to,
                                       const AxisLimits& l, int grid = 600) {
  std::vector<double> all;
  for (const double side : {1.0, -1.0}) {
    const double v0 = side * from.velocity, a0 = side * from.acceleration, vf = side * to.velocity,
                 af = side * to.acceleration;
    const double D = side * (to.position - from.position), V = l.velocity, A = l.acceleration,
                 J = l.jerk;
    // With a zero crossing at peak velocity p.
    const auto peak_profile = [&](double p, SlowProfile& out) {
      std::vector<Segment> up, down;
      out.valid = rising(v0, a0, p, A, J, up) && rising(vf, -af, p, A, J, down);
      if (!out.valid) return 0.0;
      std::reverse(down.begin(), down.end());
      out.segments = up;
      out.segments.insert(out.segments.end(), down.begin(), down.end());
      return run({0, v0, a0}, out.segments).position - D;
    };
    // Without a zero crossing: valley or peak at `b`; `early` selects which is the parameter.
    const auto flat_profile = [&](double b, bool early, SlowProfile& out) {
      std::vector<Segment> g;
      out.valid = false;
      if (!early) {  // +J to a1 (hold), -J to b in [0, af], +J to af
        const double square = b * b + J * (vf - v0) - (af * af - a0 * a0) / 2;
        if (square < 0) return 0.0;
        double a1 = std::sqrt(square), hold = 0;
        if (a1 > A) hold = (square - A * A) / (J * A), a1 = A;
        if (a1 < a0 - 1e-12 || a1 < b || b > af) return 0.0;
        g = {{std::max(0.0, a1 - a0) / J, J}, {hold, 0}, {(a1 - b) / J, -J}, {(af - b) / J, J}};
      } else {  // +J from a0 to b in [a0, 0], -J to a2 (hold), +J to af
        const double square = b * b - J * (vf - v0) + (af * af - a0 * a0) / 2;
        if (square < 0) return 0.0;
        double a2 = -std::sqrt(square), hold = 0;
        if (a2 < -A) hold = (square - A * A) / (J * A), a2 = -A;
        if (a2 > af + 1e-12 || a2 > b || b < a0) return 0.0;
        g = {{(b - a0) / J, J}, {(b - a2) / J, -J}, {hold, 0}, {std::max(0.0, af - a2) / J, J}};
      }
      out.segments = g;
      out.valid = true;
      return run({0, v0, a0}, g).position - D;
    };
    const auto scan = [&](auto&& f, double lo, double hi) {
      if (!(hi >= lo)) return;
      SlowProfile p, q;
      double last_x = 0, last_f = 0;
      bool have = false;
      for (int k = 0; k <= grid; ++k) {
        const double u = static_cast<double>(k) / grid;
        const double x = lo + (hi - lo) * u * u * (3 - 2 * u);
        const double fx = f(x, p);
        if (!p.valid) {
          have = false;
          continue;
        }
        const double near = 1e-16 * (std::abs(from.position) + std::abs(to.position) + std::abs(D));
        if (std::abs(fx) <= near) all.push_back(p.duration());
        if (have && (last_f < 0) != (fx < 0)) {
          double a = last_x, b = x;
          const bool rise = last_f < 0;
          for (int i = 0; i < 200 && a < b; ++i) {
            const double m = 0.5 * (a + b), fm = f(m, q);
            if (!q.valid || m <= a || m >= b) break;
            ((fm < 0) == rise ? a : b) = m;
          }
          f(b, q);
          if (q.valid) all.push_back(q.duration());
        }
        last_x = x;
        last_f = fx;
        have = true;
      }
    };
    const double lowest =
        std::max(v0 + a0 * std::abs(a0) / (2 * J), vf - af * std::abs(af) / (2 * J));
    scan(peak_profile, std::min(lowest, V), V);
    if (af > 0) scan([&](double b, SlowProfile& o) { return flat_profile(b, false, o); }, 0, af);
    if (a0 < 0) scan([&](double b, SlowProfile& o) { return flat_profile(b, true, o); }, a0, 0);
    SlowProfile cruise;
    const double missing = -peak_profile(V, cruise);
    if (cruise.valid && missing >= 0) all.push_back(cruise.duration() + missing / V);
  }
  std::sort(all.begin(), all.end());
  std::vector<double> out;
  for (const double t : all) {
    if (out.empty() || t > out.back() + 1e-9 * (std::abs(t) + 1e-6)) out.push_back(t);
  }
  return out;
}

inline double slow_min_time(const AxisState& from, const AxisState& to, const AxisLimits& l,
                            int grid = 600) {
  const std::vector<double> bounds = slow_bounds(from, to, l, grid);
  return bounds.empty() ? std::numeric_limits<double>::infinity() : bounds[0];
}

/// Moves the state from outside the limits to their border: an excess acceleration returns at full
/// jerk; an excess or unavoidable excess of velocity decelerates to a depth, holds it and reduces
/// it so that the return does not exceed the other limit. The max depth with time to hold is found
/// by bisection. Returns the duration [s]; negative: unknown, for a state beyond one limit that
/// heads beyond the other.
inline double slow_way_inside(AxisState& s, const AxisLimits& l) {
  const double V = l.velocity, A = l.acceleration, J = l.jerk;
  double time = 0;
  const auto go = [&](double t, double jerk) {
    s = advanced(s, t, jerk);
    time += t;
  };
  if (std::abs(s.acceleration) > A) {
    const double side = s.acceleration > 0 ? 1 : -1;
    go((std::abs(s.acceleration) - A) / J, -side * J);
    s.acceleration = side * A;
  }
  const auto heading = [&] {
    return s.velocity + s.acceleration * std::abs(s.acceleration) / (2 * J);
  };
  const bool above = s.velocity > V || (s.acceleration > 0 && heading() > V),
             below = s.velocity < -V || (s.acceleration < 0 && heading() < -V);
  if (above && below) return -1;
  if (!above && !below) return time;
  const double side = above ? 1 : -1, v = side * s.velocity, a = side * s.acceleration;
  const double steepest = std::sqrt(4 * J * V);
  const auto hold = [&](double depth) {
    const double risen = std::min(depth, steepest);
    return (v + (a * a - depth * depth) / (2 * J) - V - (depth * depth - risen * risen) / (2 * J)) /
           depth;
  };
  double lo = std::max(0.0, -a), hi = A;
  if (hold(hi) < 0) {
    for (int k = 0; k < 200; ++k) {
      const double middle = 0.5 * (lo + hi);
      (hold(middle) >= 0 ? lo : hi) = middle;
    }
  } else {
    lo = hi;
  }
  go((a + lo) / J, -side * J);
  if (lo > 0) go(std::max(0.0, hold(lo)), 0);
  if (lo > steepest) go((lo - steepest) / J, side * J);
  s.velocity = side * V;
  s.acceleration = -side * std::min(lo, steepest);
  return time;
}

}  // namespace handsel::test
