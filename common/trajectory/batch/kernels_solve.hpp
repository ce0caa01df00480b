// SPDX-License-Identifier: Apache-2.0
// Batch kernels: minimum time and imposed duration.
#pragma once

#include <array>

#include "common/trajectory/batch/simd_register.hpp"

namespace handsel::detail {
namespace {

// Where 12 x^4 + 12 x^2 = 1: the valley, over sqrt(C), of min gain.
constexpr double kInflexion = 0.27811916365;
// starts and ends this close to a limit, relative, are inside
constexpr double kBorder = 1e-12;
constexpr double kAccepted = 1e-12;      // end position, relative
constexpr double kAcceptedRate = 1e-11;  // end velocity and acceleration
constexpr double kStepToAccept = 2e-9;   // Newton: the step after this small a one is exact
constexpr int kMaxSteps = 30;

/// Cube root within 4 %, x >= 0.
[[gnu::always_inline]] inline V rough_cube_root(const V& x) noexcept {
  const U high = __builtin_bit_cast(U, x) >> 32;
  return __builtin_bit_cast(V, ((high * U(0x5556)) >> 16) + U(0x2A9F7893) << 32);
}
[[gnu::always_inline]] inline V cube_root(const V& x) noexcept {
  V y = rough_cube_root(x);
  for (int k = 0; k < 3; ++k) {
    const V y3 = y * y * y;
    y *= (y3 + 2 * x) / (2 * y3 + x);
  }
  return pick(x > 1e-290, y, 0);
}

struct Limits {
  V velocity, A, J, over_J, over_JA;
};

[[gnu::always_inline]] inline V lobe(const V& v, const V& a, const V& a1, const V& hold,
                                     const Limits& l) noexcept {
  const V t = (a1 - a) * l.over_J;
  const V v1 = v + 0.5 * t * (a1 + a);
  const V v2 = v1 + a1 * hold;
  return t * (v + t * (a * 0.5 + l.J * t * (1.0 / 6))) + hold * (v1 + v2) * 0.5 +
         a1 * l.over_J * (v2 + a1 * a1 * l.over_J * (1.0 / 3));
}

/// MotionFamily of min_time.hpp, main component.
struct Family {
  V v0, a0, vf, af, C, s_lo, s_hi, at_limit;
  M reversed;

  V duration(const V& s, const Limits& l) const noexcept {
    const V R = s * s + C, A2 = l.A * l.A;
    const V a1 = min(sqrt(R), l.A), a2 = min(s, l.A);
    return (positive(a1 - a0) + positive(a1 + a2) + positive(af + a2)) * l.over_J +
           (positive(R - A2) + positive(s * abs(s) - A2)) * l.over_JA;
  }
  V displacement(const V& s, const Limits& l) const noexcept {
    const V R = s * s + C, A2 = l.A * l.A;
    const V a1 = min(sqrt(R), l.A), a2 = min(s, l.A);
    return lobe(v0, a0, a1, positive(R - A2) * l.over_JA, l) +
           lobe(vf, -af, a2, positive(s * abs(s) - A2) * l.over_JA, l);
  }
  /// For |s| <= A.
  V displacement(const V& s, const Limits& l, V* slope) const noexcept {
    const V R = s * s + C, A2 = l.A * l.A;
    const V a1 = min(sqrt(R), l.A);
    const V peak = vf + (s * s - af * af * 0.5) * l.over_J;
    const V factor = pick(a1 > 0, 1 + s / a1, 2);
    *slope = 2 * l.over_J * factor * (peak + s * a1 * 0.5 * l.over_J);
    return lobe(v0, a0, a1, positive(R - A2) * l.over_JA, l) + lobe(vf, -af, s, 0, l);
  }
  V gain(const V& s, const Limits& l) const noexcept {
    return vf + (s * s - af * af * 0.5 + min(s, l.A) * min(sqrt(s * s + C), l.A) * 0.5) * l.over_J;
  }
  V parameter(const V& T, const Limits& l, V* cruise) const noexcept {
    const V A2 = l.A * l.A, JT = l.J * T, K = (JT + a0 - af) * 0.5;
    V s = pick(K > 0, (K - C / K) * 0.5, s_lo);
    const M held = s * s + C > A2;
    if (any_of(held)) {
      const V AK = l.A * 2 * K;
      V held_s = sqrt(positive(AK - C)) - l.A;
      where(held_s > l.A, held_s) = sqrt(max(A2, (AK - 2 * A2 - C) * 0.5));
      where(held, s) = held_s;
    }
    s = clamped(s, s_lo, s_hi);
    *cruise = positive(T - at_limit);
    return pick(T >= at_limit, s_hi, s);
  }
};

Family family(V v0, V a0, V vf, V af, const Limits& l, M* island) noexcept {
  Family f;
  const V tolerance = 256 * kEps * (a0 * a0 + af * af + l.J * (abs(v0) + abs(vf)));
  V C = l.J * (vf - v0) + (a0 - af) * (a0 + af) * 0.5;
  const M near = abs(C) <= tolerance;
  f.reversed = (near && a0 < 0 && af < 0) || (!near && C < 0);
  C = pick(near, 0, abs(C));
  f.C = C;
  f.v0 = pick(f.reversed, vf, v0);
  f.vf = pick(f.reversed, v0, vf);
  f.a0 = pick(f.reversed, -af, a0);
  f.af = pick(f.reversed, -a0, af);
  const V gap = f.a0 * f.a0 - C;
  const M blocked = f.a0 > 0 && gap > 0;
  const V r = pick(abs(gap - f.af * f.af) <= tolerance, abs(f.af), sqrt(positive(gap)));
  *island = blocked && f.af > 0 && f.af >= r;
  f.s_lo = pick(blocked, max(r, -f.af), -f.af);
  where(C == 0, f.s_lo) = positive(f.s_lo);
  f.s_hi = max(f.s_lo, sqrt(positive(l.J * (l.velocity - f.vf) + f.af * f.af * 0.5)));
  f.at_limit = f.duration(f.s_hi, l);
  return f;
}

[[gnu::always_inline]] inline Family chosen(const M& first, const Family& a,
                                            const Family& b) noexcept {
  return {pick(first, a.v0, b.v0),
          pick(first, a.a0, b.a0),
          pick(first, a.vf, b.vf),
          pick(first, a.af, b.af),
          pick(first, a.C, b.C),
          pick(first, a.s_lo, b.s_lo),
          pick(first, a.s_hi, b.s_hi),
          pick(first, a.at_limit, b.at_limit),
          (first && a.reversed) || (!first && b.reversed)};
}

void put(const Family& f, AxisBatch::Family& out, int g) noexcept {
  store(f.v0, out.start_velocity + g);
  store(f.a0, out.start_acceleration + g);
  store(f.vf, out.end_velocity + g);
  store(f.af, out.end_acceleration + g);
  store(f.C, out.C + g);
  store(f.s_lo, out.s_lo + g);
  store(f.s_hi, out.s_hi + g);
  store(f.at_limit, out.at_limit + g);
  store(pick(f.reversed, 1, 0), out.reversed + g);
}

Family get(const AxisBatch::Family& in, int g) noexcept {
  return {load(in.start_velocity + g),
          load(in.start_acceleration + g),
          load(in.end_velocity + g),
          load(in.end_acceleration + g),
          load(in.C + g),
          load(in.s_lo + g),
          load(in.s_hi + g),
          load(in.at_limit + g),
          load(in.reversed + g) > 0.5};
}

/// displacement(s) = D is to be solved from s_lo on, where displacement(s_lo) - D = f_from < 0, for
/// the axes `todo`.
struct RootProblem {
  V D, f_from;
  M todo;
};

/// First root; axes that need care are added to `odd`.
V root(const Family& f, const RootProblem& problem, const Limits& l, M* odd, V* cruise) noexcept {
  const V &D = problem.D, &f_from = problem.f_from;
  const M& todo = problem.todo;
  const V to = min(l.A, f.s_hi);
  V lo = f.s_lo, hi = to, f_lo = f_from;
  M concave(false);
  const M falls = todo && f.s_lo < 0;
  if (any_of(falls)) {
    const V at = kInflexion * sqrt(f.C), A2 = l.A * l.A;
    V turn = pick(at * at + f.C <= A2, -at, -sqrt(positive(A2 - f.C)));
    where(f.C >= 0.9375 * A2, turn) = -0.25 * l.A;
    turn = clamped(turn, f.s_lo, to);
    const M rises = f.gain(f.s_lo, l) > 0, humped = rises && f.gain(turn, l) < 0;
    const V f_turn = f.displacement(turn, l) - D;
    concave = falls && rises && !humped && f_turn >= 0;
    *odd = *odd || (falls && (humped || (!concave && f_turn >= 0)));
    const M beyond = falls && !concave;
    where(concave, hi) = turn;
    where(beyond, lo) = turn;
    where(beyond, f_lo) = f_turn;
  }
  const V f_limit = f.displacement(f.s_hi, l) - D;
  const V f_to = pick(f.s_hi <= l.A, f_limit, f.displacement(to, l) - D);
  const M found = concave || (f.s_lo < l.A && lo < to && f_to >= 0);
  M active = todo && found && !*odd;
  V s = min(hi, lo + rough_cube_root(positive(-f_lo) * l.J * l.J * 0.5));
  for (int k = 0; any_of(active); ++k) {
    if (k == kMaxSteps) {
      *odd = *odd || active;
      break;
    }
    V slope;
    const V e = f.displacement(s, l, &slope) - D;
    where(active && e < 0, lo) = s;
    where(active && e >= 0, hi) = s;
    V next = s - e / slope;
    const M bad = !(slope > 0 && next >= lo && next <= hi);
    where(bad, next) = 0.5 * (lo + hi);
    const M done = (!bad && abs(next - s) <= kStepToAccept * abs(next)) || e == 0;
    where(active && e != 0, s) = next;
    active = active && !done;
  }
  *cruise = 0;
  const M beyond = todo && !found;
  if (any_of(beyond)) {
    const V base = clamped(f.s_lo, l.A, max(l.A, f.s_hi)), f_base = f.displacement(base, l) - D;
    const V centre = f.vf + (base * base - f.af * f.af * 0.5 + l.A * l.A * 0.5) * l.over_J;
    const V reach = sqrt(positive(centre * centre - l.A * f_base));
    const V step = pick(centre >= 0, -l.A * f_base / (reach + centre), reach - centre);
    const V held = clamped(sqrt(base * base + l.J * positive(step)), base, max(base, f.s_hi));
    const M cruises = f_limit <= 0;
    where(beyond, s) = pick(cruises, f.s_hi, held);
    where(beyond && cruises, *cruise) = -f_limit / l.velocity;
  }
  return s;
}

struct AxisGroup {
  V distance, scale, v0, a0, vf, af;
  Limits limits;
};

[[gnu::always_inline]] inline V read(const double* p, const M& there, double otherwise) noexcept {
  V out = otherwise;
  where(there, out).copy_from(p, stdx::element_aligned);
  return out;
}

M prepare_rest(const AxisGroup& in, AxisBatch& block, int g) noexcept {
  const Limits& l = in.limits;
  const V D = abs(in.distance), A2 = l.A * l.A, VJ = l.velocity * l.J;
  const V to_acceleration = l.A * l.over_J;
  const M full = VJ >= A2;
  const V peak_jerk = pick(full, to_acceleration, sqrt(l.velocity * l.over_J));
  const V peak_hold = pick(full, (VJ - A2) * l.over_JA, 0);
  const V cruising = D - l.velocity * (2 * peak_jerk + peak_hold);
  const M holds = full && D >= 2 * l.A * to_acceleration * to_acceleration, cruises = cruising >= 0;
  V tj = cube_root(D * l.over_J * 0.5), ta = 0, tv = 0;
  where(holds, tj) = to_acceleration;
  where(holds, ta) =
      positive(sqrt(0.25 * to_acceleration * to_acceleration + D / l.A) - 1.5 * to_acceleration);
  where(cruises, tj) = peak_jerk;
  where(cruises, ta) = peak_hold;
  where(cruises, tv) = cruising / l.velocity;
  where(D == 0, tj) = 0;
  where(D == 0, ta) = 0;
  store(tj, block.phase[0] + g);
  store(ta, block.phase[1] + g);
  store(tv, block.phase[2] + g);
  store(in.distance, block.phase[3] + g);
  const V lowest = 4 * tj + 2 * ta + tv;
  store(lowest, block.minimum + g);
  return !(lowest < 1e300) || (D != 0 && tj <= 1e-90);
}

M prepare_any(const AxisGroup& in, AxisBatch& block, int g) noexcept {
  const Limits& l = in.limits;
  M island_up, island_down;
  const Family up = family(in.v0, in.a0, in.vf, in.af, l, &island_up),
               down = family(-in.v0, -in.a0, -in.vf, -in.af, l, &island_down);
  const V highest = up.displacement(up.s_lo, l), lowest = -down.displacement(down.s_lo, l);
  const V tolerance = 256 * kEps * (in.scale + abs(lowest) + abs(highest)), D = in.distance;
  const M rises = D > highest + tolerance, falls = D < lowest - tolerance;
  const M still = D == 0 && in.v0 == 0 && in.a0 == 0 && in.vf == 0 && in.af == 0;
  M odd = island_up || island_down || !(rises || falls || still);
  const Family f = chosen(rises, up, down);
  V cruise = 0;
  V s = root(f, {pick(rises, D, -D), pick(rises, highest - D, D - lowest), !odd && !still}, l, &odd,
             &cruise);
  where(still, s) = 0;
  const V minimum = pick(still, 0, f.duration(s, l) + cruise);
  odd = odd || !(minimum < 1e300);
  put(up, block.up, g);
  put(down, block.down, g);
  store(s, block.s + g);
  store(cruise, block.cruise + g);
  store(pick(rises, 1, -1), block.side + g);
  store(minimum, block.minimum + g);
  return odd;
}

std::uint32_t prepare(const AxisBatchInput& in, int first, int axes, AxisBatch& block) noexcept {
  std::uint32_t out = 0;
  std::array<AxisGroup, kBatchAxes / kWidth> groups;
  M moving(false);
  for (int g = 0; g < kBatchAxes; g += kWidth) {
    const M there = numbers() + g < axes;
    const auto all = [&](const double* p, double otherwise) {
      return read(p + first + g, there, otherwise);
    };
    AxisGroup& x = groups[static_cast<std::size_t>(g / kWidth)];
    const V begin = all(in.position, 0), end = all(in.end_position, 0);
    x.distance = end - begin;
    x.scale = abs(end) + abs(begin);
    x.v0 = all(in.velocity, 0), x.a0 = all(in.acceleration, 0);
    x.vf = all(in.end_velocity, 0), x.af = all(in.end_acceleration, 0);
    Limits& l = x.limits;
    l.velocity = all(in.max_velocity, 1), l.A = all(in.max_acceleration, 1),
    l.J = all(in.max_jerk, 1);
    l.over_J = 1 / l.J;
    l.over_JA = l.over_J / l.A;
    const V half_over_J = 0.5 * l.over_J, max_v = l.velocity * (1 + kBorder),
            max_a = l.A * (1 + kBorder);
    const V ahead = x.v0 + x.a0 * abs(x.a0) * half_over_J,
            behind = x.vf - x.af * abs(x.af) * half_over_J;
    const V lowest = min(min(l.velocity, l.A), l.J), highest = max(max(l.velocity, l.A), l.J);
    const M usual = x.scale < 1e30 && lowest > 1e-30 && highest < 1e30 && abs(x.v0) <= max_v &&
                    abs(x.vf) <= max_v && abs(x.a0) <= max_a && abs(x.af) <= max_a &&
                    abs(ahead) <= max_v && abs(behind) <= max_v;
    out |= bits(!usual) << g;
    moving = moving || !(x.v0 == 0 && x.a0 == 0 && x.vf == 0 && x.af == 0);
    store(x.distance, block.distance + g);
    store(x.scale, block.scale + g);
    store(x.v0, block.velocity + g);
    store(x.a0, block.acceleration + g);
    store(x.vf, block.end_velocity + g);
    store(x.af, block.end_acceleration + g);
    store(l.velocity, block.max_velocity + g);
    store(l.A, block.max_acceleration + g);
    store(l.J, block.max_jerk + g);
  }
  block.rest = none_of(moving);
  block.axis_bits = (1U << axes) - 1;
  for (int g = 0; g < kBatchAxes; g += kWidth) {
    const AxisGroup& x = groups[static_cast<std::size_t>(g / kWidth)];
    out |= bits(block.rest ? prepare_rest(x, block, g) : prepare_any(x, block, g)) << g;
    if (g + kWidth >= axes) break;
  }
  out &= block.axis_bits;
  for (int i = 0; i < kBatchAxes; ++i) {
    if (i >= axes || (out >> i & 1)) block.minimum[i] = 0;
  }
  return out;
}

struct Knot {
  V time, step;
};

[[gnu::always_inline]] inline void compare_swap(Knot& a, Knot& b) noexcept {
  const M turned = a.time > b.time;
  const V late = max(a.time, b.time), step = pick(turned, a.step, b.step);
  a.time = min(a.time, b.time);
  a.step = pick(turned, b.step, a.step);
  b.time = late;
  b.step = step;
}

/// Odd-even merge of two sorted rows.
template <std::size_t N>
std::array<Knot, 2 * N> merged(const std::array<Knot, N>& a,
                               const std::array<Knot, N>& b) noexcept {
  std::array<Knot, 2 * N> out;
  if constexpr (N == 1) {
    out = {a[0], b[0]};
    compare_swap(out[0], out[1]);
  } else {
    constexpr std::size_t kOdd = (N + 1) / 2, kEven = N / 2;
    std::array<Knot, kOdd> a1, b1;
    std::array<Knot, kEven> a2, b2;
    for (std::size_t i = 0; i < kOdd; ++i) a1[i] = a[2 * i], b1[i] = b[2 * i];
    for (std::size_t i = 0; i < kEven; ++i) a2[i] = a[2 * i + 1], b2[i] = b[2 * i + 1];
    const std::array<Knot, 2 * kOdd> odd = merged(a1, b1);
    const std::array<Knot, 2 * kEven> even = merged(a2, b2);
    out[0] = odd[0];
    for (std::size_t i = 0; i + 1 < 2 * N; ++i) {
      const std::size_t k = i / 2;
      if (i % 2 == 1) continue;
      if (k < 2 * kEven && k + 1 < 2 * kOdd) {
        out[i + 1] = even[k];
        out[i + 2] = odd[k + 1];
        compare_swap(out[i + 1], out[i + 2]);
      } else if (k < 2 * kEven) {
        out[i + 1] = even[k];
      } else {
        out[i + 1] = odd[k + 1];
      }
    }
  }
  return out;
}

/// Inner knots of a motion of the family: where its jerk changes, and by how much.
std::array<Knot, 6> knots(const Family& f, const V& s, const V& cruise, const V& T, const V& jerk,
                          const Limits& l) noexcept {
  const V R = s * s + f.C, A2 = l.A * l.A;
  const V a1 = min(sqrt(R), l.A), a2 = min(s, l.A);
  const V t1 = positive(a1 - f.a0) * l.over_J, h1 = positive(R - A2) * l.over_JA,
          h2 = positive(s * abs(s) - A2) * l.over_JA, t5 = positive(a2 + f.af) * l.over_J;
  const M cruises = cruise > 0;
  const V fall1 = pick(cruises, a1, positive(a1 + a2)) * l.over_J,
          fall2 = pick(cruises, a2, 0) * l.over_J;
  const auto turned = [&f](const V& ahead, const V& back) { return pick(f.reversed, back, ahead); };
  std::array<Knot, 6> out;
  out[0].time = turned(t1, t5);
  out[1].time = out[0].time + turned(h1, h2);
  out[2].time = out[1].time + pick(f.reversed && cruises, a2 * l.over_J, fall1);
  out[3].time = out[2].time + cruise;
  out[4].time = out[3].time + pick(f.reversed && cruises, a1 * l.over_J, fall2);
  out[5].time = out[4].time + turned(h2, h1);
  for (std::size_t k = 0; k < 6; ++k) {
    out[k].time = min(out[k].time, T);
    out[k].step = k == 2 || k >= 4 ? jerk : -jerk;
  }
  return out;
}

M finish_rest(AxisBatch& block, const V& T, int g) noexcept {
  const V lowest = load(block.minimum + g), D = load(block.distance + g),
          J = load(block.max_jerk + g);
  const M still = D == 0;
  const V stretch = pick(still, 1, T / lowest);
  const V tj = load(block.phase[0] + g) * stretch, ta = load(block.phase[1] + g) * stretch,
          tv = pick(still, T, load(block.phase[2] + g) * stretch);
  const V jerk = pick(still, 0, D / (tj * (tj + ta) * (2 * tj + ta + tv)));
  const std::array<V, 7> t{tj, ta, tj, tv, tj, ta, tj}, j{jerk, 0, -jerk, 0, -jerk, 0, jerk};
  for (std::size_t k = 0; k < 7; ++k) {
    store(t[k], block.duration[k] + g);
    store(j[k], block.jerk[k] + g);
  }
  return !(abs(jerk) <= J * (1 + kAccepted));
}

M finish_any(AxisBatch& block, const V& T, int g, M* blocked) noexcept {
  Limits l{load(block.max_velocity + g),
           load(block.max_acceleration + g),
           load(block.max_jerk + g),
           {},
           {}};
  l.over_J = 1 / l.J;
  l.over_JA = l.over_J / l.A;
  const Family up = get(block.up, g), down = get(block.down, g);
  const V D = load(block.distance + g), scale = load(block.scale + g),
          minimum = load(block.minimum + g);
  V cruise_up, cruise_down;
  V s_up = up.parameter(T, l, &cruise_up), s_down = down.parameter(T, l, &cruise_down);
  const V best_s = load(block.s + g), best_cruise = load(block.cruise + g);
  const M fastest = T <= minimum * (1 + 4 * kEps), rises = load(block.side + g) > 0;
  where(fastest && rises, s_up) = best_s;
  where(fastest && rises, cruise_up) = best_cruise;
  where(fastest && !rises, s_down) = best_s;
  where(fastest && !rises, cruise_down) = best_cruise;
  const V highest = up.displacement(s_up, l) + cruise_up * l.velocity,
          lowest = -(down.displacement(s_down, l) + cruise_down * l.velocity);
  const V size = scale + abs(lowest) + abs(highest), tolerance = 256 * kEps * size,
          width = highest - lowest;
  *blocked = !fastest && (D > highest + tolerance || D < lowest - tolerance);
  V weight = pick(width > 0, clamped((D - lowest) / width, 0, 1), 0.5);
  where(fastest && minimum > 0, weight) = pick(rises, 1, 0);
  std::array<Knot, 6> high = knots(up, s_up, cruise_up, T, weight * l.J, l),
                      low = knots(down, s_down, cruise_down, T, (weight - 1) * l.J, l);
  const M still = D == 0 && minimum == 0, only_low = still || weight == 0,
          only_high = still || weight == 1;
  for (std::size_t k = 0; k < 6; ++k) {
    where(only_low, high[k].time) = T;
    where(only_high, low[k].time) = T;
  }
  const std::array<Knot, 12> all = merged(high, low);
  const V v0 = load(block.velocity + g), a0 = load(block.acceleration + g);
  V x = 0, v = v0, a = a0, jerk = (2 * weight - 1) * l.J, time = 0;
  for (std::size_t k = 0; k < kBatchSegments; ++k) {
    const V next = k < 12 ? all[k].time : T, t = next - time;
    store(t, block.duration[k] + g);
    store(jerk, block.jerk[k] + g);
    x += t * (v + t * (0.5 * a + t * jerk * (1.0 / 6)));
    v += t * (a + 0.5 * t * jerk);
    a += t * jerk;
    time = next;
    if (k < 12) jerk += all[k].step;
  }
  const V vf = load(block.end_velocity + g), af = load(block.end_acceleration + g);
  return !(abs(x - D) <= kAccepted * size && abs(v - vf) <= kAcceptedRate * l.velocity &&
           abs(a - af) <= kAcceptedRate * l.A);
}

std::uint32_t finish(AxisBatch& block, const double* durations, std::uint32_t leave,
                     std::uint32_t* blocked) noexcept {
  std::uint32_t failed = 0, stands = 0;
  block.segments = block.rest ? 7 : kBatchSegments;
  for (int g = 0; g < kBatchAxes && block.axis_bits >> g != 0; g += kWidth) {
    const V T(durations + g, stdx::element_aligned);
    M stopped(false);
    failed |= bits(block.rest ? finish_rest(block, T, g) : finish_any(block, T, g, &stopped)) << g;
    stands |= bits(stopped) << g;
  }
  const std::uint32_t wanted = block.axis_bits & ~leave;
  *blocked = stands & wanted;
  return failed & wanted;
}

}  // namespace
}  // namespace handsel::detail
