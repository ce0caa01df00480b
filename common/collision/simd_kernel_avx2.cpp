// SPDX-License-Identifier: Apache-2.0
#include "common/collision/simd_kernel_body.hpp"

namespace handsel::detail {
const SimdKernels kSimdKernelsAvx2{"avx2", kWidth, check, distances};
}  // namespace handsel::detail
