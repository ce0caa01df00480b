// SPDX-License-Identifier: Apache-2.0
// The one source of the batch kernels, compiled once per register width.
#pragma once

#include "common/trajectory/batch/kernels_motion.hpp"
#include "common/trajectory/batch/kernels_solve.hpp"

namespace handsel::detail {
namespace {

constexpr BatchKernels kernels(const char* name) noexcept {
  return {name,       prepare,       finish,     evaluate,   rates,
          push_range, push_range_at, step_holds, blend_ratio};
}

}  // namespace
}  // namespace handsel::detail
