#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const BatchKernels kBatchKernelsBase = kernels("base");
}  // namespace handsel::detail
