// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/batch/kernels_body.hpp"

namespace handsel::detail {
constinit const BatchKernels kBatchKernelsBase = kernels("base");
}  // namespace handsel::detail
