#include "common/collision/simd_kernel_body.hpp"

namespace handsel::detail {
const WideKernels kWideKernelsBase{"base", kWidth, check, distances};
}  // namespace handsel::detail
