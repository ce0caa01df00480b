// SPDX-License-Identifier: Apache-2.0
#include "common/collision/simd_kernel.hpp"

namespace handsel::detail {

const SimdKernels& simd_kernels() noexcept {
#ifdef HANDSEL_SIMD_UNITS
  static const SimdKernels& best =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
              __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
          ? kSimdKernelsAvx512
      : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? kSimdKernelsAvx2
                                                                        : kSimdKernelsBase;
  return best;
#else
  return kSimdKernelsBase;
#endif
}

}  // namespace handsel::detail
