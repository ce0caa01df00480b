// SPDX-License-Identifier: Apache-2.0
// Computes one row of the cost map's layers with SIMD. Single precision without Eigen: one source
// for every register width, selected at run time. Does not allocate or throw.
#pragma once

#include <cstdint>

namespace handsel::costmap::detail {

constexpr int kMaxRow = 128;

/// Person and settings, lengths in m, frame of the grid's first point.
struct RowPerson {
  float axis_x, axis_y, bottom, height, radius;  ///< of the body cylinder
  float head[3], head_radius;
  float over_safety_radius;                 ///< 1 / R
  float eyes[3], gaze[3];                   ///< unit gaze
  float cutoff;                             ///< max distance of visibility; 0: unknown gaze
  float w_safety, w_visibility, w_comfort;  ///< their sum is 1
};

/// The points (i * step, y, z) with i < n, lengths in m.
struct RowPoints {
  float y, z, step;
  int n;  ///< at most 128
};

/// Writes a row of safety, visibility and total as cost * 254. Reads `comfort`; 255 counts as
/// cost 1.
using FillRow = void (*)(const RowPerson& person, const RowPoints& points,
                         const std::uint8_t* comfort, std::uint8_t* safety,
                         std::uint8_t* visibility, std::uint8_t* total) noexcept;

void fill_row_base(const RowPerson&, const RowPoints&, const std::uint8_t*, std::uint8_t*,
                   std::uint8_t*, std::uint8_t*) noexcept;
#ifdef HANDSEL_SIMD_UNITS
void fill_row_avx2(const RowPerson&, const RowPoints&, const std::uint8_t*, std::uint8_t*,
                   std::uint8_t*, std::uint8_t*) noexcept;
#endif
/// Returns the function with the max register width of this processor.
FillRow fill_row() noexcept;

}  // namespace handsel::costmap::detail
