// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/batch/kernels.hpp"

#include <array>

namespace handsel::detail {

namespace {

/// Returns the kernels this processor supports, the widest SIMD first; the rest is null.
std::array<const BatchKernels*, 3> present() noexcept {
#ifdef HANDSEL_SIMD_UNITS
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (avx512) return {&kBatchKernelsAvx512, &kBatchKernelsAvx2, &kBatchKernelsBase};
  if (avx2) return {&kBatchKernelsAvx2, &kBatchKernelsBase, nullptr};
#endif
  return {&kBatchKernelsBase, nullptr, nullptr};
}

const BatchKernels*& chosen() noexcept {
  static const BatchKernels* kernels = present()[0];
  return kernels;
}

}  // namespace

const BatchKernels& batch_kernels() noexcept { return *chosen(); }

bool choose_batch_kernels(std::string_view name) noexcept {
  for (const BatchKernels* kernels : present()) {
    if (!kernels || kernels->name != name) continue;
    chosen() = kernels;
    return true;
  }
  return false;
}

}  // namespace handsel::detail
