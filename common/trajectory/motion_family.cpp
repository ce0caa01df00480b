// SPDX-License-Identifier: Apache-2.0
// Motions of max displacement of one axis; the class is declared in min_time.hpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/trajectory/min_time.hpp"

namespace handsel {

namespace {
constexpr double kUnitRounding = std::numeric_limits<double>::epsilon();
// Solution of 12 x^4 + 12 x^2 = 1: the valley, divided by sqrt(C), of min gain.
constexpr double kInflexion = 0.27811916365;

double lobe(double v, double a, double a1, double hold, double J, double over_J) noexcept {
  const double t = (a1 - a) * over_J;
  const double v1 = v + 0.5 * t * (a1 + a);
  const double v2 = v1 + a1 * hold;
  return t * (v + t * (a / 2 + J * t * (1.0 / 6))) + hold * (v1 + v2) * 0.5 +
         a1 * over_J * (v2 + a1 * a1 * over_J * (1.0 / 3));
}
}  // namespace

namespace detail {

MotionFamily::MotionFamily(double v0, double a0, double vf, double af, const AxisLimits& limits,
                           bool mirrored) noexcept
    : V_(limits.velocity),
      A_(limits.acceleration),
      J_(limits.jerk),
      over_J_(1 / J_),
      over_JA_(over_J_ / A_),
      mirrored_(mirrored) {
  if (mirrored) v0 = -v0, a0 = -a0, vf = -vf, af = -af;
  const double tolerance =
      256 * kUnitRounding * (a0 * a0 + af * af + J_ * (std::abs(v0) + std::abs(vf)));
  C_ = J_ * (vf - v0) + (a0 - af) * (a0 + af) / 2;
  if (std::abs(C_) <= tolerance) {
    C_ = 0;
    reversed_ = a0 < 0 && af < 0;
  } else {
    reversed_ = C_ < 0;
    C_ = std::abs(C_);
  }
  if (reversed_) {
    std::swap(v0, vf);
    std::swap(a0, af);
    a0 = -a0;
    af = -af;
  }
  v0_ = v0, a0_ = a0, vf_ = vf, af_ = af;
  const double gap = a0 * a0 - C_;
  s_lo = -af;
  if (a0 > 0 && gap > 0) {
    const double r = std::abs(gap - af * af) <= tolerance ? std::abs(af) : std::sqrt(gap);
    if (af > 0 && af >= r) {
      island = true;
      island_lo = -af;
      island_hi = -std::min(r, af);
    }
    s_lo = std::max(r, -af);
  }
  if (C_ == 0) s_lo = std::max(s_lo, 0.0);
  s_hi = std::max(s_lo, std::sqrt(std::max(0.0, J_ * (V_ - vf) + af * af / 2)));
  at_limit_ = duration(s_hi);
}

bool MotionFamily::gap_is_rounding() const noexcept {
  return island && island_hi * island_hi <= 1e-13 * A_ * (a0_ + std::sqrt(C_));
}

void MotionFamily::close_gap() noexcept {
  s_lo = C_ == 0 ? std::max(island_lo, 0.0) : island_lo;
  island = false;
}

double MotionFamily::duration(double s) const noexcept {
  const double R = s * s + C_, A2 = A_ * A_;
  const double a1 = R < A2 ? std::sqrt(R) : A_;
  const double changes = std::max(0.0, a1 - a0_) + std::max(0.0, a1 + std::min(s, A_)) +
                         std::max(0.0, af_ + std::min(s, A_));
  double t = changes * over_J_;
  if (R > A2) t += (R - A2) * over_JA_;
  if (s > A_) t += (s * s - A2) * over_JA_;
  return t;
}

double MotionFamily::displacement(double s, double* slope) const noexcept {
  const double R = s * s + C_, A2 = A_ * A_;
  const double a1 = R < A2 ? std::sqrt(R) : A_, h1 = R > A2 ? (R - A2) * over_JA_ : 0.0;
  const double a2 = std::min(s, A_), h2 = s > A_ ? (s * s - A2) * over_JA_ : 0.0;
  if (slope) {
    const double peak = vf_ + (s * s - af_ * af_ / 2) * over_J_;
    const double factor = a1 > 0 ? 1 + s / a1 : 2.0;
    *slope = 2 * over_J_ * factor * (peak + s * a1 * 0.5 * over_J_);
  }
  return lobe(v0_, a0_, a1, h1, J_, over_J_) + lobe(vf_, -af_, a2, h2, J_, over_J_);
}

double MotionFamily::parameter(double T, double* cruise) const noexcept {
  *cruise = 0;
  if (T >= at_limit_) {
    *cruise = T - at_limit_;
    return s_hi;
  }
  const double A2 = A_ * A_, JT = J_ * T;
  double s;
  const double K = (JT + a0_ - af_) / 2;
  s = K > 0 ? (K - C_ / K) / 2 : s_lo;
  if (s * s + C_ > A2) {
    s = -A_ + std::sqrt(std::max(0.0, A_ * (JT + a0_ - af_) - C_));
    if (s > A_) s = std::sqrt(std::max(A2, (A_ * (JT + a0_ - af_) - 2 * A2 - C_) / 2));
  }
  return std::clamp(s, s_lo, s_hi);
}

double MotionFamily::displacement_at(double T) const noexcept {
  double cruise;
  const double s = parameter(T, &cruise);
  return displacement(s) + cruise * V_;
}

double MotionFamily::parameter_in_island(double T) const noexcept {
  const double JT = J_ * T, K = (JT + a0_ - af_) / 2;
  double s = K > 0 ? (K - C_ / K) / 2 : island_lo;
  if (s * s + C_ > A_ * A_) s = -A_ + std::sqrt(std::max(0.0, A_ * (JT + a0_ - af_) - C_));
  return std::clamp(s, island_lo, island_hi);
}

double MotionFamily::bracketed(double D, double lo, double hi, double f_lo) const noexcept {
  if (!(f_lo < 0) || !(lo < hi)) return lo;
  double s = std::min(hi, lo + std::cbrt(-f_lo * J_ * J_ / 2));
  double best = lo, best_f = std::abs(f_lo);
  for (int k = 0; k < 100; ++k) {
    double slope;
    const double f = displacement(s, &slope) - D;
    if (std::abs(f) < best_f) best = s, best_f = std::abs(f);
    if (f == 0) return s;
    (f < 0 ? lo : hi) = s;
    double next = s - f / slope;
    if (!(slope > 0) || !(next > lo && next < hi)) {
      if (std::abs(next - s) <= 2 * kUnitRounding * std::abs(s)) return best;
      next = 0.5 * (lo + hi);
      if (!(next > lo && next < hi)) return best;
    }
    if (std::abs(next - s) <= kUnitRounding * std::abs(next))
      return best_f < std::abs(f) ? best : next;
    s = next;
  }
  return best;
}

double MotionFamily::gain(double s) const noexcept {
  const double a1 = std::min(std::sqrt(s * s + C_), A_);
  return vf_ + (s * s - af_ * af_ / 2 + std::min(s, A_) * a1 / 2) / J_;
}

double MotionFamily::min_gain() const noexcept {
  const double A2 = A_ * A_;
  if (C_ >= 0.9375 * A2) return -A_ / 4;
  const double root = kInflexion * std::sqrt(C_);
  return root * root + C_ <= A2 ? -root : -std::sqrt(A2 - C_);
}

double MotionFamily::top(double lo, double hi) const noexcept {
  double g_lo = gain(lo), g_hi = gain(hi), middle = lo;
  int side = 0;
  for (int k = 0; k < 60; ++k) {
    middle = k < 40 ? (lo * g_hi - hi * g_lo) / (g_hi - g_lo) : 0.5 * (lo + hi);
    if (!(middle > lo && middle < hi)) break;
    const double g = gain(middle);
    if (g == 0 || hi - lo <= 2 * kUnitRounding * std::abs(middle)) break;
    // The value of the retained end is halved, so that both ends converge (Illinois method).
    if (g > 0) {
      lo = middle, g_lo = g;
      if (side == 1) g_hi /= 2;
      side = 1;
    } else {
      hi = middle, g_hi = g;
      if (side == -1) g_lo /= 2;
      side = -1;
    }
  }
  return middle;
}

bool MotionFamily::first_root(double D, double from, double to, double* s) const noexcept {
  double f = displacement(from) - D;
  *s = from;
  if (f >= 0) return true;
  if (from < 0) {
    const double turn = std::clamp(min_gain(), from, to);
    if (gain(from) > 0) {
      double peak = turn;
      if (gain(turn) < 0) peak = top(from, turn);
      if (displacement(peak) >= D) {
        *s = bracketed(D, from, peak, f);
        return true;
      }
    }
    from = turn;
    f = displacement(from) - D;
    if (f >= 0) {
      *s = from;
      return true;
    }
  }
  if (from >= to || displacement(to) < D) return false;
  *s = bracketed(D, from, to, f);
  return true;
}

double MotionFamily::root(double D, double from, double* cruise) const noexcept {
  *cruise = 0;
  double s;
  if (from < A_ && first_root(D, from, std::min(A_, s_hi), &s)) return s;
  const double at_limit = displacement(s_hi);
  if (D >= at_limit) {
    *cruise = (D - at_limit) / V_;
    return s_hi;
  }
  const double base = std::clamp(from, A_, s_hi), f_base = displacement(base) - D;
  const double centre = vf_ + (base * base - af_ * af_ / 2) / J_ + A_ * A_ / (2 * J_);
  const double square = std::max(0.0, centre * centre - A_ * f_base);
  const double step =
      centre >= 0 ? -A_ * f_base / (std::sqrt(square) + centre) : std::sqrt(square) - centre;
  return std::clamp(std::sqrt(base * base + J_ * std::max(0.0, step)), base, s_hi);
}

void MotionFamily::emit(double s, double cruise, AxisProfile& out, double scale) const noexcept {
  const double R = s * s + C_, A2 = A_ * A_, j = scale * (mirrored_ ? -J_ : J_);
  const double a1 = R < A2 ? std::sqrt(R) : A_, a2 = std::min(s, A_);
  const double t1 = (a1 - a0_) * over_J_, h1 = R > A2 ? (R - A2) * over_JA_ : 0.0,
               h2 = s > A_ ? (s * s - A2) * over_JA_ : 0.0, t5 = (a2 + af_) * over_J_;
  if (reversed_) {
    out.push(t5, j);
    out.push(h2, 0);
  } else {
    out.push(t1, j);
    out.push(h1, 0);
  }
  if (cruise > 0) {
    out.push((reversed_ ? a2 : a1) * over_J_, -j);
    out.push(cruise, 0);
    out.push((reversed_ ? a1 : a2) * over_J_, -j);
  } else {
    out.push((a1 + a2) * over_J_, -j);
  }
  if (reversed_) {
    out.push(h1, 0);
    out.push(t1, j);
  } else {
    out.push(h2, 0);
    out.push(t5, j);
  }
}

}  // namespace detail

}  // namespace handsel
