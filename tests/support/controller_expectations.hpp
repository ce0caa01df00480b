// SPDX-License-Identifier: Apache-2.0
// Common expectations of the controller's tests.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/controller_bench.hpp"

namespace handsel::test {

inline bool has(const ControllerBench& b, Cause cause) {
  return (b.core.status().causes & bit(cause)) != 0;
}
inline Vector goal() { return ControllerBench::arm(0.6, 0.4, -0.5); }

/// Every set-point so far within the guard limits, and continuous.
inline void expect_smooth(const ControllerBench& b) {
  EXPECT_LE(b.worst_velocity, 1 + 1e-6);
  EXPECT_LE(b.worst_acceleration, 1 + 1e-6);
  EXPECT_LE(b.worst_jerk, 1 + 1e-6);
  EXPECT_LE(b.worst_jump, 1 + 1e-6);
}

}  // namespace handsel::test
