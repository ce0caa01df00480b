// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const BatchKernels kBatchKernelsAvx512 = kernels("avx512");
}  // namespace handsel::detail
