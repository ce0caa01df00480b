// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const BatchKernels kBatchKernelsAvx2 = kernels("avx2");
}  // namespace handsel::detail
