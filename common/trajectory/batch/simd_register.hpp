// SPDX-License-Identifier: Apache-2.0
// One register of doubles, as wide as the unit that includes this is compiled for. Everything is
// local to that unit: a function of a unit for wide registers must never be the one the linker
// keeps for the others.
#pragma once

#include <experimental/simd>

#include <limits>

#include "common/trajectory/batch/kernels.hpp"

namespace handsel::detail {
namespace {

namespace stdx = std::experimental;
using V = stdx::native_simd<double>;
using M = V::mask_type;
using U = stdx::native_simd<std::uint64_t>;
constexpr int kWidth = static_cast<int>(V::size());
static_assert(kBatchAxes % kWidth == 0);

constexpr double kEps = std::numeric_limits<double>::epsilon();

[[gnu::always_inline]] inline V pick(const M& m, const V& a, const V& b) noexcept {
  V out = b;
  where(m, out) = a;
  return out;
}
[[gnu::always_inline]] inline V load(const double* p) noexcept {
  return V(p, stdx::vector_aligned);
}
[[gnu::always_inline]] inline void store(const V& v, double* p) noexcept {
  v.copy_to(p, stdx::vector_aligned);
}
[[gnu::always_inline]] inline V clamped(const V& x, const V& lo, const V& hi) noexcept {
  return min(max(x, lo), hi);
}
[[gnu::always_inline]] inline V positive(const V& x) noexcept { return max(x, V(0.0)); }
[[gnu::always_inline]] inline std::uint32_t bits(const M& m) noexcept {
  std::uint32_t out = 0;
  for (int i = 0; i < kWidth; ++i)
    out |= static_cast<std::uint32_t>(m[static_cast<std::size_t>(i)]) << i;
  return out;
}
[[gnu::always_inline]] inline V numbers() noexcept {
  return V([](auto i) { return static_cast<double>(i); });
}

}  // namespace
}  // namespace handsel::detail
