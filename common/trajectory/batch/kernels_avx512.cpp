#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const BatchKernels kBatchKernelsAvx512 = kernels("avx512");
}  // namespace handsel::detail
