#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const LaneKernels kLaneKernelsBase = kernels("base");
}  // namespace handsel::detail
