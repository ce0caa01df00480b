#include "common/trajectory/batch/kernels.hpp"

#include <array>

namespace handsel::detail {

namespace {

/// Those of this processor, the widest first; the rest is empty.
std::array<const LaneKernels*, 3> present() noexcept {
#ifdef HANDSEL_WIDE_LANES
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512bw");
  if (avx512) return {&kLaneKernelsAvx512, &kLaneKernelsAvx2, &kLaneKernelsBase};
  if (avx2) return {&kLaneKernelsAvx2, &kLaneKernelsBase, nullptr};
#endif
  return {&kLaneKernelsBase, nullptr, nullptr};
}

const LaneKernels*& chosen() noexcept {
  static const LaneKernels* kernels = present()[0];
  return kernels;
}

}  // namespace

const LaneKernels& lane_kernels() noexcept { return *chosen(); }

bool choose_lanes(std::string_view name) noexcept {
  for (const LaneKernels* kernels : present()) {
    if (!kernels || kernels->name != name) continue;
    chosen() = kernels;
    return true;
  }
  return false;
}

}  // namespace handsel::detail
