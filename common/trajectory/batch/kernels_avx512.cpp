#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const LaneKernels kLaneKernelsAvx512 = kernels("avx512");
}  // namespace handsel::detail
