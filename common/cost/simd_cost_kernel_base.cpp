// SPDX-License-Identifier: Apache-2.0
#include "common/cost/simd_cost_kernel_body.hpp"

namespace handsel::detail {
const CostKernel kCostKernelBase{"base", run};
}  // namespace handsel::detail
