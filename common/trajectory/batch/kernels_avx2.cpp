#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const LaneKernels kLaneKernelsAvx2 = kernels("avx2");
}  // namespace handsel::detail
