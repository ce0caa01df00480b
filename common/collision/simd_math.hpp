// SPDX-License-Identifier: Apache-2.0
// Registers of states side by side, as wide as the unit that includes this is compiled for.
// Everything is local to that unit: a function of a unit for wide registers must never be the one
// the linker keeps for the others.
#pragma once

#include <bitset>
#include <experimental/simd>

#include "common/collision/simd_kernel.hpp"

namespace handsel::detail {
namespace {

namespace stdx = std::experimental;
using V = stdx::native_simd<float>;
using M = V::mask_type;
constexpr int kWidth = static_cast<int>(V::size());
static_assert(kBatchStates % kWidth == 0);

[[gnu::always_inline]] inline V load(const float* p) noexcept { return V(p, stdx::vector_aligned); }
[[gnu::always_inline]] inline void store(const V& v, float* p) noexcept {
  v.copy_to(p, stdx::vector_aligned);
}
[[gnu::always_inline]] inline V positive(const V& x) noexcept { return max(x, V(0.0f)); }
[[gnu::always_inline]] inline V unit(const V& x) noexcept { return min(max(x, V(0.0f)), V(1.0f)); }
[[gnu::always_inline]] inline std::uint32_t bits(const M& m) noexcept {
  return static_cast<std::uint32_t>(m.__to_bitset().to_ulong());
}

/// Sine and cosine within 2e-7 for |x| < 50: quarter turns taken off in three parts, then
/// polynomials.
[[gnu::always_inline]] inline void sine_cosine(const V& x, V& sine, V& cosine) noexcept {
  // 1.5 * 2^23: adding it rounds to an integer in the last bits.
  constexpr float kRound = 12582912.0f;
  const V shifted = x * 0.636619772f + kRound;
  const V turns = shifted - kRound;
  const V y = ((x - turns * 1.5703125f) - turns * 4.83751296997e-4f) - turns * 7.54978995489e-8f;
  const V y2 = y * y;
  const V s = y + y * y2 * (-1.6666654611e-1f + y2 * (8.3321608736e-3f - y2 * 1.9515295891e-4f));
  const V c =
      1.0f - 0.5f * y2 +
      y2 * y2 *
          (4.166664568298827e-2f + y2 * (-1.388731625493765e-3f + y2 * 2.443315711809948e-5f));
  const V half = turns * 0.5f;
  const V odd = abs(half - ((half + kRound) - kRound));  // 0.5 for odd turns
  const M swap = odd > 0.25f;
  const V quarter = turns * 0.25f;
  const V rest = turns - 4.0f * ((quarter + kRound) - kRound);  // -2 ... 2
  V out_s = s, out_c = c;
  where(swap, out_s) = c;
  where(swap, out_c) = s;
  const M two = abs(rest) > 1.5f;
  where(two || (swap && rest < 0.0f), out_s) = -out_s;
  where(two || (swap && rest > 0.0f), out_c) = -out_c;
  sine = out_s;
  cosine = out_c;
}

/// Poses of the bodies behind `count` joints, 12 rows of kWidth each, kBatchStates x 12 floats
/// apart; body 0 is at `root`. q: positions, rows of kBatchStates.
[[maybe_unused]] inline void forward(const SimdJoint* joints, int count, const float root[12],
                                     const float* q, float* pose) noexcept {
  for (int i = 0; i < 12; ++i) store(V(root[i]), pose + i * kWidth);
  for (int j = 0; j < count; ++j) {
    const SimdJoint& joint = joints[j];
    const float* above = pose + joint.parent * 12 * kBatchStates;
    float* out = pose + (j + 1) * 12 * kBatchStates;
    const V value = load(q + joint.row * kBatchStates) * joint.factor + joint.offset;
    V sine, cosine;
    if (!joint.slides) sine_cosine(value, sine, cosine);
    const float* T = joint.T;
    for (int i = 0; i < 3; ++i) {
      const V a = load(above + (4 * i) * kWidth), b = load(above + (4 * i + 1) * kWidth),
              c = load(above + (4 * i + 2) * kWidth);
      const V x = a * T[0] + b * T[4] + c * T[8];
      const V y = a * T[1] + b * T[5] + c * T[9];
      const V z = a * T[2] + b * T[6] + c * T[10];
      V p = load(above + (4 * i + 3) * kWidth) + a * T[3] + b * T[7] + c * T[11];
      if (joint.slides) {
        p += z * value;
        store(x, out + (4 * i) * kWidth);
        store(y, out + (4 * i + 1) * kWidth);
      } else {
        store(x * cosine + y * sine, out + (4 * i) * kWidth);
        store(y * cosine - x * sine, out + (4 * i + 1) * kWidth);
      }
      store(z, out + (4 * i + 2) * kWidth);
      store(p, out + (4 * i + 3) * kWidth);
    }
  }
}

}  // namespace
}  // namespace handsel::detail
