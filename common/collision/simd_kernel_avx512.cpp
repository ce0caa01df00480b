// SPDX-License-Identifier: Apache-2.0
#include "common/collision/simd_kernel_body.hpp"

namespace handsel::detail {
const SimdKernels kSimdKernelsAvx512{"avx512", kWidth, check, distances};
}  // namespace handsel::detail
