// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/min_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace handsel {

namespace {
constexpr double kEps = std::numeric_limits<double>::epsilon();

bool finite(const AxisState& s) noexcept {
  return std::isfinite(s.position) && std::isfinite(s.velocity) && std::isfinite(s.acceleration);
}
}  // namespace

const char* reason(AxisOutcome outcome) noexcept {
  switch (outcome) {
    case AxisOutcome::ok:
      return "";
    case AxisOutcome::not_finite:
      return "a number is not finite or too large";
    case AxisOutcome::bad_limits:
      return "a limit is not positive";
    case AxisOutcome::end_beyond_limits:
      return "the end state cannot be reached inside the limits";
    case AxisOutcome::too_short:
      return "the imposed duration is below the minimum";
    case AxisOutcome::wrong_size:
      return "a state or the limits have another number of axes";
    case AxisOutcome::blocked:
      return "no motion inside the limits has the imposed duration";
  }
  return "";
}

namespace {

/// Brings a state with v beyond +V (or bound to exceed it) back to V as fast as possible without
/// then exceeding -V; `side` -1 mirrors.
void brake_velocity(AxisState& s, const AxisLimits& l, double side, AxisProfile& out) noexcept {
  const double V = l.velocity, A = l.acceleration, J = l.jerk;
  const double v = side * s.velocity, a = side * s.acceleration;
  const auto go = [&](double t, double jerk) {
    t = std::max(0.0, t);
    out.push(t, side * jerk);
    s = advanced(s, t, side * jerk);
  };
  const double at_V = std::sqrt(std::max(0.0, a * a + 2 * J * (v - V)));
  const double turning = std::sqrt(std::max(0.0, J * (v + V) + a * a / 2));
  const double deepest = std::min(turning, A);
  if (at_V <= deepest) return go((a + at_V) / J, -J);
  go((a + deepest) / J, -J);
  const double v1 = side * s.velocity, last = std::sqrt(4 * J * V);
  if (deepest == A) go(std::min(v1 - V, v1 + V - A * A / (2 * J)) / A, 0);
  if (deepest > last) go((deepest - last) / J, J);
}

void bring_inside(AxisState& s, const AxisLimits& l, AxisProfile& out, double slack) noexcept {
  const double V = l.velocity, A = l.acceleration, J = l.jerk;
  if (std::abs(s.acceleration) > A * (1 + slack)) {
    const double side = s.acceleration > 0 ? 1 : -1, t = (std::abs(s.acceleration) - A) / J;
    out.push(t, -side * J);
    s = advanced(s, t, -side * J);
    s.acceleration = side * A;
  }
  for (int pass = 0; pass < 2; ++pass) {
    const double a = s.acceleration, rest = s.velocity + a * std::abs(a) / (2 * J),
                 bound = V * (1 + slack);
    const bool below = a < 0 && rest<-bound, above = a> 0 && rest > bound;
    const double side = below                 ? -1
                        : above               ? 1
                        : s.velocity > bound  ? 1
                        : s.velocity < -bound ? -1
                                              : 0;
    if (side == 0) return;
    brake_velocity(s, l, side, out);
  }
}

/// Adds weight * jerk of one profile to another, cutting both at each other's ends.
void blend(const AxisProfile& p, double weight_p, const AxisProfile& q, double weight_q,
           AxisProfile& out) noexcept {
  int i = 0, k = 0;
  double left_p = p.count ? p.segments[0].duration : 0,
         left_q = q.count ? q.segments[0].duration : 0;
  while (i < p.count && k < q.count) {
    const double step = std::min(left_p, left_q);
    out.push(step, weight_p * p.segments[i].jerk + weight_q * q.segments[k].jerk);
    left_p -= step;
    left_q -= step;
    if (left_p <= 0 && ++i < p.count) left_p = p.segments[i].duration;
    if (left_q <= 0 && ++k < q.count) left_q = q.segments[k].duration;
  }
  for (; i < p.count; ++i, left_p = i < p.count ? p.segments[i].duration : 0)
    out.push(left_p, weight_p * p.segments[i].jerk);
  for (; k < q.count; ++k, left_q = k < q.count ? q.segments[k].duration : 0)
    out.push(left_q, weight_q * q.segments[k].jerk);
}

}  // namespace

AxisOutcome AxisProblem::init(const AxisState& from, const AxisState& to,
                              const AxisLimits& l) noexcept {
  if (!finite(from) || !finite(to) || !std::isfinite(l.velocity + l.acceleration + l.jerk))
    return AxisOutcome::not_finite;
  if (!(l.velocity > 0) || !(l.acceleration > 0) || !(l.jerk > 0)) return AxisOutcome::bad_limits;
  constexpr double kSlack = 1e-12;
  const double end = to.velocity - to.acceleration * std::abs(to.acceleration) / (2 * l.jerk);
  if (std::abs(to.velocity) > l.velocity * (1 + kSlack) ||
      std::abs(to.acceleration) > l.acceleration * (1 + kSlack) ||
      std::abs(end) > l.velocity * (1 + kSlack)) {
    return AxisOutcome::end_beyond_limits;
  }
  brake_.clear();
  AxisState start = from;
  bring_inside(start, l, brake_, kSlack);
  brake_time_ = brake_.duration();
  distance_ = to.position - start.position;
  scale_ = std::abs(to.position) + std::abs(start.position);
  over_J_ = 1 / l.jerk;
  speed_ = std::abs(start.velocity) + std::abs(to.velocity) +
           (start.acceleration * start.acceleration + to.acceleration * to.acceleration) * over_J_;
  still_ = distance_ == 0 && start.velocity == 0 && start.acceleration == 0 && to.velocity == 0 &&
           to.acceleration == 0;
  rest_ =
      start.velocity == 0 && start.acceleration == 0 && to.velocity == 0 && to.acceleration == 0;
  up_ = detail::MotionFamily(start.velocity, start.acceleration, to.velocity, to.acceleration, l,
                             false);
  if (still_) {
    best_ = {0, 0, 0, false};
    minimum_ = brake_time_;
    return AxisOutcome::ok;
  }
  if (rest_) {
    best_ = {0, 0, 0, distance_ < 0};
    best_.s = up_.root(std::abs(distance_), 0, &best_.cruise);
    best_.duration = up_.duration(best_.s) + best_.cruise;
    minimum_ = brake_time_ + best_.duration;
    return std::isfinite(minimum_) ? AxisOutcome::ok : AxisOutcome::not_finite;
  }
  down_ = detail::MotionFamily(start.velocity, start.acceleration, to.velocity, to.acceleration, l,
                               true);
  start_ = from;
  end_ = to;
  limits_ = l;
  settle_islands();
  best_ = first_from(0);
  minimum_ = brake_time_ + best_.duration;
  return std::isfinite(minimum_) ? AxisOutcome::ok : AxisOutcome::not_finite;
}

/// Makes the possible durations of the max and the min displacement agree; if the two families
/// differ, rounding has decided in one of them.
void AxisProblem::settle_islands() noexcept {
  for (detail::MotionFamily* f : {&up_, &down_}) {
    if (f->gap_is_rounding()) f->close_gap();
  }
  const double up = up_.duration(up_.s_lo), down = down_.duration(down_.s_lo);
  alike_ = std::abs(up - down) <= 1e-6 * up;
  main_ = alike_ ? up : std::max(up, down);
}

double AxisProblem::slack(const Span& at) const noexcept {
  const double speed = speed_ + (at.s_up * at.s_up + at.s_down * at.s_down) * over_J_;
  return 256 * kEps * (scale_ + std::abs(at.smallest) + std::abs(at.largest)) +
         16 * kEps * at.T * speed;
}

AxisProblem::Choice AxisProblem::first_from(double T) const noexcept {
  const double D = distance_;
  if (up_.island && down_.island) {
    const double last = up_.duration(up_.island_hi), first = up_.duration(up_.island_lo);
    if (T <= last) {
      const double from = std::max(T, first);
      const double s_up = T <= first ? up_.island_lo : up_.parameter_in_island(T);
      const double s_down = T <= first ? down_.island_lo : down_.parameter_in_island(T);
      const double largest = up_.displacement(s_up), smallest = -down_.displacement(s_down);
      const double tolerance = 2 * slack({from, s_up, s_down, 0, 0, largest, smallest});
      if (D <= largest + tolerance && D >= smallest - tolerance) {
        return D - smallest > largest - D ? Choice{from, s_up, 0, false}
                                          : Choice{from, s_down, 0, true};
      }
      double s;
      if (D > largest && up_.first_root(D, s_up, up_.island_hi, &s))
        return {up_.duration(s), s, 0, false};
      if (D < smallest && down_.first_root(-D, s_down, down_.island_hi, &s))
        return {down_.duration(s), s, 0, true};
      const double ending = up_.displacement(up_.island_hi);
      if (std::abs(D - ending) <= tolerance) return {last, up_.island_hi, 0, false};
    }
  }
  Span at = span_at(T > main_ ? T : alike_ ? -1 : main_);
  at.T = std::max(T, main_);
  const double tolerance = slack(at);
  double cruise;
  if (D > at.largest && (D > at.largest + tolerance || (at.s_up >= 0 && up_.gain(at.s_up) >= 0))) {
    const double s = up_.root(D, at.s_up, &cruise);
    return {up_.duration(s) + cruise, s, cruise, false};
  }
  if (D < at.smallest &&
      (D < at.smallest - tolerance || (at.s_down >= 0 && down_.gain(at.s_down) >= 0))) {
    const double s = down_.root(-D, at.s_down, &cruise);
    return {down_.duration(s) + cruise, s, cruise, true};
  }
  return {at.T, at.s_up, at.cruise_up, false};
}

AxisProblem::Span AxisProblem::span_at(double T) const noexcept {
  Span at;
  at.T = T;
  if (T < 0) {
    at.s_up = up_.s_lo;
    at.s_down = down_.s_lo;
  } else {
    at.s_up = up_.parameter(T, &at.cruise_up);
    at.s_down = down_.parameter(T, &at.cruise_down);
  }
  at.largest = up_.displacement(at.s_up) + at.cruise_up * up_.cruise_velocity();
  at.smallest = -(down_.displacement(at.s_down) + at.cruise_down * down_.cruise_velocity());
  return at;
}

double AxisProblem::earliest(double duration) const noexcept {
  if (still_ || rest_ || duration <= minimum_) return std::max(duration, minimum_);
  const double T = duration - brake_time_;
  const double found = first_from(T).duration;
  return found <= T ? duration : brake_time_ + found;
}

void AxisProblem::minimum_profile(AxisProfile& out) const noexcept {
  out = brake_;
  if (rest_) {
    up_.emit(best_.s, best_.cruise, out, best_.mirrored ? -1 : 1);
  } else if (!still_) {
    (best_.mirrored ? down_ : up_).emit(best_.s, best_.cruise, out);
  }
}

AxisOutcome AxisProblem::profile(double duration, AxisProfile& out) const noexcept {
  if (!std::isfinite(duration)) return AxisOutcome::not_finite;
  if (duration < minimum_ * (1 - 1e-12)) return AxisOutcome::too_short;
  if (still_) {
    out = brake_;
    out.push(duration - brake_time_, 0);
    return AxisOutcome::ok;
  }
  if (duration <= minimum_ * (1 + 4 * kEps)) {
    minimum_profile(out);
    return AxisOutcome::ok;
  }
  const double T = duration - brake_time_;
  if (rest_) {
    double cruise;
    const double s = up_.parameter(T, &cruise);
    out = brake_;
    up_.emit(s, cruise, out, distance_ / (up_.displacement(s) + cruise * up_.cruise_velocity()));
    return AxisOutcome::ok;
  }
  Span at;
  if (up_.island && down_.island && T <= up_.duration(up_.island_hi)) {
    at.T = T;
    at.s_up = up_.parameter_in_island(T);
    at.s_down = down_.parameter_in_island(T);
    at.largest = up_.displacement(at.s_up);
    at.smallest = -down_.displacement(at.s_down);
  } else {
    if (T < main_ * (1 - 1e-14)) return AxisOutcome::blocked;
    at = span_at(T);
  }
  return profile_in(at, out);
}

AxisOutcome AxisProblem::profile_in(const Span& at, AxisProfile& out) const noexcept {
  const double D = distance_, tolerance = slack(at), width = at.largest - at.smallest;
  if (D > at.largest + 2 * tolerance || D < at.smallest - 2 * tolerance)
    return AxisOutcome::blocked;
  const double weight = width > 0 ? std::clamp((D - at.smallest) / width, 0.0, 1.0) : 0.5;
  out = brake_;
  if (weight == 1.0) {
    up_.emit(at.s_up, at.cruise_up, out);
  } else if (weight == 0.0) {
    down_.emit(at.s_down, at.cruise_down, out);
  } else {
    AxisProfile high, low;
    up_.emit(at.s_up, at.cruise_up, high);
    down_.emit(at.s_down, at.cruise_down, low);
    blend(high, weight, low, 1 - weight, out);
  }
  return arrives(out, brake_time_ + at.T) ? AxisOutcome::ok : AxisOutcome::blocked;
}

/// Returns whether a profile arrives; rounding may invalidate a solution, which is then not
/// returned.
bool AxisProblem::arrives(const AxisProfile& profile, double duration) const noexcept {
  constexpr double kNear = 1e-9;
  AxisState s = start_;
  double T = 0, fastest = limits_.velocity;
  for (int k = 0; k < profile.count; ++k) {
    fastest = std::max(fastest, std::abs(s.velocity));
    s = advanced(s, profile.segments[k].duration, profile.segments[k].jerk);
    T += profile.segments[k].duration;
  }
  const double hardest = std::max(limits_.acceleration, std::abs(start_.acceleration));
  return std::abs(T - duration) <= kNear * duration &&
         std::abs(s.position - end_.position) <= kNear * (scale_ + fastest * T) &&
         std::abs(s.velocity - end_.velocity) <= kNear * fastest &&
         std::abs(s.acceleration - end_.acceleration) <= kNear * hardest;
}

AxisOutcome solve_axis(const AxisState& from, const AxisState& to, const AxisLimits& limits,
                       AxisProfile& out) noexcept {
  AxisProblem problem;
  const AxisOutcome outcome = problem.init(from, to, limits);
  if (outcome == AxisOutcome::ok) problem.minimum_profile(out);
  return outcome;
}

double rest_to_rest_time(double distance, const AxisLimits& l) noexcept {
  const double D = std::abs(distance), V = l.velocity, A = l.acceleration, J = l.jerk;
  if (!(D > 0)) return 0;
  if (V * J >= A * A) {
    const double d1 = V * V / A + V * A / J, d2 = 2 * A * A * A / (J * J);
    if (D >= d1) return 4 * A / J + 2 * (V / A - A / J) + (D - d1) / V;
    if (D >= d2) return 4 * A / J + 2 * (-1.5 * A / J + std::sqrt(A * A / (4 * J * J) + D / A));
  } else {
    const double d1 = 2 * V * std::sqrt(V / J);
    if (D >= d1) return 4 * std::sqrt(V / J) + (D - d1) / V;
  }
  return 4 * std::cbrt(D / (2 * J));
}

}  // namespace handsel
