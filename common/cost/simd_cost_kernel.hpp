// SPDX-License-Identifier: Apache-2.0
// Safety and visibility of sixteen states of a robot side by side, and where points of it are.
// Plain data in single precision, in a frame along the world's axes with its origin at the robot's
// base. The same source for every register width, chosen when the program runs; every width gives
// the same bits. Nothing here allocates, locks or throws.
#pragma once

#include <cstdint>

#include "common/collision/simd_kernel.hpp"

namespace handsel::detail {

struct CostCapsule {
  float a[3], b[3], radius, half;  ///< ends in the frame of the body; half its length
  std::int32_t body;
};

struct CostPoint {
  float p[3];
  std::int32_t body;
};

struct CostPerson {
  float axis_x, axis_y, bottom, height, radius;  ///< of the body cylinder
  float head[3], head_radius;
  float over_safety_radius;  ///< 1 / R
  float eyes[3], gaze[3];    ///< unit gaze
  float cutoff;              ///< of visibility; 0: no gaze is known
};

struct CostTables {
  const SimdJoint* joints;
  const CostCapsule* capsules;
  const CostPoint* points;  ///< visibility is that of the first
  const CostPerson* people;
  std::int32_t joint_count, capsule_count, point_count, people_count;
  float root[12];  ///< of the robot, by rows
};

/// On 64 bytes, rows of kBatchStates: pose 12 a body, ends 8 a capsule; out: safety and visibility
/// one a person, point 3 a point.
struct CostMemory {
  float *pose, *ends, *safety, *visibility, *point;
};

struct CostKernel {
  const char* name;
  /// q as in SimdKernels; the first `count` of kBatchStates states are written.
  void (*run)(const CostTables& tables, const CostMemory& memory, const float* q,
              int count) noexcept;
};

extern const CostKernel kCostKernelBase;
#ifdef HANDSEL_SIMD_UNITS
extern const CostKernel kCostKernelAvx2;
extern const CostKernel kCostKernelAvx512;
#endif
/// The widest this processor has.
const CostKernel& cost_kernel() noexcept;

}  // namespace handsel::detail
