// SPDX-License-Identifier: Apache-2.0
// The functions of the costs for single numbers and for registers of them, in single precision.
// Local to the unit that includes them: see common/collision/simd_math.hpp.
#pragma once

#include <cmath>

namespace handsel::detail {
namespace {

/// e^u for u in [-1, 0], relative error below 2e-7: the series about the middle.
template <class T>
[[gnu::always_inline]] inline T exp_unit(const T& u) noexcept {
  const T x = u + 0.5f;
  return 0.60653066f *
         (1.0f +
          x * (1.0f +
               x * (1 / 2.f +
                    x * (1 / 6.f +
                         x * (1 / 24.f + x * (1 / 120.f + x * (1 / 720.f + x * (1 / 5040.f))))))));
}

/// Safety cost for penetration - 1 in [-1, 0].
template <class T>
[[gnu::always_inline]] inline T safety_of(const T& u) noexcept {
  constexpr float kInverseE = 0.36787944f;  // 1/e
  return (exp_unit(u) - kInverseE) * (1 / (1 - kInverseE));
}

/// acos(c) / pi for c in [-1, 1], error below 2.2e-5 (Abramowitz and Stegun 4.4.45).
template <class T>
[[gnu::always_inline]] inline T acos_fraction(const T& c) noexcept {
  using std::copysign;
  using std::fabs;
  using std::sqrt;
  const T x = fabs(c);
  const T half = sqrt(1.0f - x) *
                 (1.5707288f + x * (-0.2121144f + x * (0.0742610f + x * -0.0187293f))) *
                 0.31830989f;
  return 0.5f - copysign(0.5f - half, c);
}

}  // namespace
}  // namespace handsel::detail
