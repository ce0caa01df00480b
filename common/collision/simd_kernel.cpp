#include "common/collision/simd_kernel.hpp"

namespace handsel::detail {

const WideKernels& wide_kernels() noexcept {
#ifdef HANDSEL_WIDE_LANES
  static const WideKernels& best = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                                           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
                                       ? kWideKernelsAvx512
                                   : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? kWideKernelsAvx2
                                                                                                     : kWideKernelsBase;
  return best;
#else
  return kWideKernelsBase;
#endif
}

}  // namespace handsel::detail
