// SPDX-License-Identifier: Apache-2.0
#include "common/cost/simd_cost_kernel_body.hpp"

namespace handsel::detail {
const CostKernel kCostKernelAvx2{"avx2", run};
}  // namespace handsel::detail
