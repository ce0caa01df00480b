// SPDX-License-Identifier: Apache-2.0
// Batch kernels: evaluation, time scaling, blends at waypoints.
#pragma once

#include <algorithm>

#include "common/trajectory/batch/simd_register.hpp"

namespace handsel::detail {
namespace {

void evaluate(const double* row, int axes, int stride, double time,
              const BatchState& out) noexcept {
  double *const position = out.position, *const velocity = out.velocity,
                *const acceleration = out.acceleration;
  const V t = time, t2 = 0.5 * time, t3 = time * (1.0 / 3);
  for (int i = 0; i < axes; i += kWidth, row += kWidth) {
    const V x = load(row), v = load(row + stride), a = load(row + 2 * stride),
            j = load(row + 3 * stride);
    const V a_t = a + t * j, v_t = v + t * (a + t2 * j), x_t = x + t * (v + t2 * (a + t3 * j));
    if (axes - i >= kWidth) {
      x_t.copy_to(position + i, stdx::element_aligned);
      v_t.copy_to(velocity + i, stdx::element_aligned);
      a_t.copy_to(acceleration + i, stdx::element_aligned);
    } else {
      const M there = numbers() < axes - i;
      where(there, x_t).copy_to(position + i, stdx::element_aligned);
      where(there, v_t).copy_to(velocity + i, stdx::element_aligned);
      where(there, a_t).copy_to(acceleration + i, stdx::element_aligned);
    }
  }
}

void rates(const double* row, int stride, double time, double* out) noexcept {
  const V t = time, t2 = 0.5 * time;
  for (int i = 0; i < stride; i += kWidth) {
    const V v = load(row + stride + i), a = load(row + 2 * stride + i),
            j = load(row + 3 * stride + i);
    store(v + t * (a + t2 * j), out + i);
    store(a + t * j, out + stride + i);
    store(j, out + 2 * stride + i);
  }
}

/// Where w times alpha'' plus c stays within a bound.
struct PushRange {
  V low, high;
  M impossible{false};

  explicit PushRange(const double* range) : low(range[0]), high(range[1]) {}
  void within(const V& c, const V& w, const V& bound) noexcept {
    const M free = abs(w) < 1e-12;
    impossible = impossible || (free && abs(c) > bound + 1e-9);
    const V inverse = 1 / w, centre = -c * inverse, half = bound * abs(inverse);
    where(!free, low) = max(low, centre - half);
    where(!free, high) = min(high, centre + half);
  }
  bool give(double* range) const noexcept {
    range[0] = hmax(low);
    range[1] = hmin(high);
    return none_of(impossible);
  }
};

bool push_range(const ScalingStep& s, const double* begin, const double* end,
                double* range) noexcept {
  PushRange out(range);
  const V h = s.step, b = s.beta, a0 = s.alpha, a1 = s.alpha + s.step * s.beta;
  const V a0_squared = a0 * a0, a0_cubed = a0 * a0_squared, a1_squared = a1 * a1,
          a1_cubed = a1_squared * a1;
  for (int i = 0; i < s.stride; i += kWidth) {
    const V A = load(s.limits + i), J = load(s.limits + s.stride + i), held_J = s.margin * J;
    const V v0 = load(begin + i), q0 = load(begin + s.stride + i),
            j0 = load(begin + 2 * s.stride + i);
    const V v1 = load(end + i), q1 = load(end + s.stride + i), j1 = load(end + 2 * s.stride + i);
    const V steady0 = a0_cubed * j0, steady1 = a1_cubed * j1;
    out.within(steady0 + 3 * a0 * b * q0, v0, max(held_J, abs(steady0)));
    out.within(steady1 + 3 * a1 * b * q1,
               v1 + 3 * h * (q1 * (a1 + h * b * 0.5) + h * a1_squared * j1 * 0.5),
               max(held_J, min(abs(steady1), abs(j1))));
    const V push1 = a1_squared * q1, gain1 = h * (v1 + h * a1 * q1);
    out.within(push1 + b * v1, gain1, max(s.margin * A, min(abs(push1), abs(q1))));
    const V change = push1 - a0_squared * q0;
    out.within(change + b * (v1 - v0), gain1, max(held_J * h, min(abs(change), s.whole * J * h)));
  }
  return out.give(range);
}

bool push_range_at(const ScalingStep& s, double after, const double* there,
                   double* range) noexcept {
  PushRange out(range);
  const V t = after, b = s.beta, a = s.alpha + after * s.beta, a_cubed = a * a * a;
  for (int i = 0; i < s.stride; i += kWidth) {
    const V v = load(there + i), q = load(there + s.stride + i), j = load(there + 2 * s.stride + i),
            steady = a_cubed * j;
    out.within(steady + 3 * a * b * q, v + 3 * a * q * t,
               max(s.margin * load(s.limits + s.stride + i), min(abs(steady), abs(j))));
  }
  return out.give(range);
}

bool step_holds(const ScalingStep& s, const ScalingStep& next, double push, double allowed,
                const double* begin, const double* end) noexcept {
  const V a0 = s.alpha, b0 = s.beta, a1 = next.alpha, b1 = next.beta, u = push, bound = allowed,
          h = s.step;
  M beyond(false);
  for (int i = 0; i < s.stride; i += kWidth) {
    const V A = load(s.limits + i) * bound, J = load(s.limits + s.stride + i) * bound;
    const V v0 = load(begin + i), q0 = load(begin + s.stride + i);
    const V v1 = load(end + i), q1 = load(end + s.stride + i), j1 = load(end + 2 * s.stride + i);
    const V from = a0 * a0 * q0 + b0 * v0, to = a1 * a1 * q1 + b1 * v1,
            jerk = a1 * (a1 * a1 * j1 + 3 * b1 * q1) + u * v1;
    beyond = beyond || abs(to) > A || abs(to - from) > J * h || abs(jerk) > J;
  }
  return none_of(beyond);
}

double blend_ratio(const Blend& blend, const double* weight_a, const double* weight_b,
                   const double* inverse, int stride, double enough) noexcept {
  double ratio = 0;
  for (int i = 0; i < stride; i += kWidth) {
    const V wa = load(weight_a + i), wb = load(weight_b + i);
    const V over_v = load(inverse + i), over_a = load(inverse + stride + i),
            over_j = load(inverse + 2 * stride + i);
    V v = wa * blend.a.velocity[0] + wb * blend.b.velocity[0],
      a = wa * blend.a.acceleration[0] + wb * blend.b.acceleration[0];
    V worst = max(abs(v) * over_v, abs(a) * over_a);
    for (int k = 0; k < blend.count; ++k) {
      const V j = wa * blend.a.jerk[k] + wb * blend.b.jerk[k];
      const V v1 = wa * blend.a.velocity[k + 1] + wb * blend.b.velocity[k + 1];
      const V a1 = wa * blend.a.acceleration[k + 1] + wb * blend.b.acceleration[k + 1];
      worst = max(max(worst, abs(j) * over_j), max(abs(v1) * over_v, abs(a1) * over_a));
      const M turns = a * a1 < 0;
      if (any_of(turns)) worst = max(worst, pick(turns, abs(v - a * a / (2 * j)) * over_v, 0));
      if (any_of(worst > enough)) return hmax(worst);
      v = v1;
      a = a1;
    }
    ratio = std::max(ratio, hmax(worst));
  }
  return ratio;
}

}  // namespace
}  // namespace handsel::detail
