// SPDX-License-Identifier: Apache-2.0
#include "components/costmap/layer_kernel.hpp"

namespace handsel::costmap::detail {

FillRow fill_row() noexcept {
#ifdef HANDSEL_SIMD_UNITS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return fill_row_avx2;
#endif
  return fill_row_base;
}

}  // namespace handsel::costmap::detail
