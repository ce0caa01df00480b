#include "common/collision/simd_kernel_body.hpp"

namespace handsel::detail {
const WideKernels kWideKernelsAvx512{"avx512", kWidth, check, distances};
}  // namespace handsel::detail
