#include "common/trajectory/lanes.hpp"

namespace handsel::detail {

const LaneKernels& lane_kernels() noexcept {
#ifdef HANDSEL_WIDE_LANES
  static const LaneKernels& best = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                                           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
                                       ? kLaneKernelsAvx512
                                   : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? kLaneKernelsAvx2
                                                                                                     : kLaneKernelsBase;
  return best;
#else
  return kLaneKernelsBase;
#endif
}

}  // namespace handsel::detail
