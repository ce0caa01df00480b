// SPDX-License-Identifier: Apache-2.0
// Eight axes side by side in one register: minimum time, and motions of imposed duration, of the
// usual problems. What is not usual (starts outside the limits, borders decided by rounding,
// isolated short durations, humps of the displacement, bad numbers) is marked odd and left to
// min_time.hpp. Every motion is integrated and compared with the end wanted before it is handed
// out. The method is that of min_time.hpp, where it is derived. Written once for any register
// width, chosen when the program runs; free of Eigen, whose alignment depends on the width. Nothing
// here allocates, locks or throws.
#pragma once

#include <cstdint>
#include <string_view>

namespace handsel::detail {

constexpr int kBatchAxes = 8;
constexpr int kBatchSegments = 13;
using BatchArray = double[kBatchAxes];

/// Axis i of a block is entry `first + i` of each array.
struct AxisBatchInput {
  const double *position, *velocity, *acceleration;              ///< start
  const double *end_position, *end_velocity, *end_acceleration;  ///< end
  const double *max_velocity, *max_acceleration, *max_jerk;
};

/// What is known of eight axes between the steps, and the result: `segments` pieces an axis, some
/// of no duration.
struct alignas(64) AxisBatch {
  struct Family {
    BatchArray start_velocity, start_acceleration, end_velocity, end_acceleration, C, s_lo, s_hi,
        at_limit, reversed;
  };
  BatchArray distance, scale, velocity, acceleration, end_velocity, end_acceleration, max_velocity,
      max_acceleration, max_jerk;
  Family up, down;
  BatchArray s, cruise, side;  // of the fastest motion; side +1 up, -1 down
  BatchArray minimum;          ///< minimum duration [s]
  BatchArray duration[kBatchSegments], jerk[kBatchSegments];
  BatchArray phase[4];  // rest to rest: jerk, acceleration, velocity phases [s], sign
  std::uint32_t axis_bits;
  std::int32_t segments;
  bool rest;
};

struct alignas(64) BatchRow {
  double value[kBatchAxes];
};

/// Where the time scaling is within a path, and the limits to keep there: `limits` of acceleration,
/// then of jerk, each part `stride` long.
struct ScalingStep {
  double alpha, beta;  ///< d(tau)/dt and its rate [1/s]
  double step;         ///< [s]
  double margin;       ///< of the limits, that alpha'' may use
  double whole;        ///< of the jerk limit over a step, where the path itself uses more than that
  const double* limits;
  int stride;
};

/// Two scalar motions with common knots. An axis moves by the first times its weight plus the
/// second times its other weight.
struct Blend {
  static constexpr int kSegments = 16;
  struct Motion {
    double velocity[kSegments + 1], acceleration[kSegments + 1];  ///< at the knots
    double jerk[kSegments];
  };
  int count;  ///< segments
  double duration[kSegments];
  Motion a, b;
};

/// Where evaluate() writes the state of all axes, one number an axis in each array.
struct BatchState {
  double *position, *velocity, *acceleration;
};

struct BatchKernels {
  const char* name;
  /// Reads as many axes as its third argument says; returns the bits of the odd ones, whose minimum
  /// is 0.
  std::uint32_t (*prepare)(const AxisBatchInput& in, int first, int axes,
                           AxisBatch& block) noexcept;
  /// Motions of the durations wanted, one an axis. Returns the bits of the axes that failed;
  /// `blocked`: bits of those for which the duration is blocked. The bits in `leave` are neither
  /// computed nor returned.
  std::uint32_t (*finish)(AxisBatch& block, const double* durations, std::uint32_t leave,
                          std::uint32_t* blocked) noexcept;
  /// State `t` after the start of a segment: `row` has positions, velocities, accelerations and
  /// jerks of all axes, each part `stride` long, a multiple of kBatchAxes; on 64 bytes.
  void (*evaluate)(const double* row, int axes, int stride, double t,
                   const BatchState& out) noexcept;
  /// Velocities, accelerations, jerks of the path at that time; each part `stride` long, on 64
  /// bytes. The same layout is read below.
  void (*rates)(const double* row, int stride, double t, double* out) noexcept;
  /// Narrows the range of alpha'' to what keeps the limits at both ends of a step, whose end is
  /// known up to what alpha'' adds to it. False if nothing does.
  bool (*push_range)(const ScalingStep& at, const double* begin, const double* end,
                     double* range) noexcept;
  /// The same for the jerk at one place passed `after` the begin of the step.
  bool (*push_range_at)(const ScalingStep& at, double after, const double* there,
                        double* range) noexcept;
  /// Whether a step that ends in `next` keeps limits * `allowed` there, and the acceleration's
  /// change over it.
  bool (*step_holds)(const ScalingStep& at, const ScalingStep& next, double push, double allowed,
                     const double* begin, const double* end) noexcept;
  /// Largest ratio of an axis of the blend to its limit, on the exact extremes; some ratio beyond
  /// `enough` as soon as one is found. `inverse`: 1 / limit of velocity, acceleration, jerk, each
  /// part `stride` long.
  double (*blend_ratio)(const Blend&, const double* weight_a, const double* weight_b,
                        const double* inverse, int stride, double enough) noexcept;
};

extern const BatchKernels kBatchKernelsBase;
#ifdef HANDSEL_SIMD_UNITS
extern const BatchKernels kBatchKernelsAvx2;
extern const BatchKernels kBatchKernelsAvx512;
#endif
/// The widest this processor has, unless others were chosen.
const BatchKernels& batch_kernels() noexcept;
/// For tests, before anything else runs: "avx512", "avx2" or "base" from now on; false if this
/// processor does not have them.
bool choose_batch_kernels(std::string_view name) noexcept;

}  // namespace handsel::detail
