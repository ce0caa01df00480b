// SPDX-License-Identifier: Apache-2.0
#include "common/cost/simd_cost_kernel.hpp"

namespace handsel::detail {

const CostKernel& cost_kernel() noexcept {
#ifdef HANDSEL_SIMD_UNITS
  static const CostKernel& best =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
              __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
          ? kCostKernelAvx512
      : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? kCostKernelAvx2
                                                                        : kCostKernelBase;
  return best;
#else
  return kCostKernelBase;
#endif
}

}  // namespace handsel::detail
