// A row of the cost map's layers at once. Plain single precision, no Eigen: the same source for
// every register width, chosen when the program runs. Nothing here allocates or throws.
#pragma once

#include <cstdint>

namespace handsel::costmap::detail {

constexpr int kMaxRow = 128;

/// The person and the settings, lengths in m, frame of the grid's first point.
struct RowPerson {
  float axis_x, axis_y, bottom, height, radius;  ///< of the body cylinder
  float head[3], head_radius;
  float over_safety_radius;                 ///< 1 / R
  float eyes[3], gaze[3];                   ///< unit gaze
  float cutoff;                             ///< of visibility; 0: no gaze is known
  float w_safety, w_visibility, w_comfort;  ///< their sum is 1
};

/// The points (i * step, y, z) with i < n, lengths in m.
struct RowPoints {
  float y, z, step;
  int n;  ///< at most 128
};

/// Fills the points of a row. `comfort` is read (255 counts as cost 1), the others are written as
/// cost * 254.
using FillRow = void (*)(const RowPerson& person, const RowPoints& points,
                         const std::uint8_t* comfort, std::uint8_t* safety,
                         std::uint8_t* visibility, std::uint8_t* total) noexcept;

void fill_row_base(const RowPerson&, const RowPoints&, const std::uint8_t*, std::uint8_t*,
                   std::uint8_t*, std::uint8_t*) noexcept;
#ifdef HANDSEL_SIMD_UNITS
void fill_row_avx2(const RowPerson&, const RowPoints&, const std::uint8_t*, std::uint8_t*,
                   std::uint8_t*, std::uint8_t*) noexcept;
#endif
/// The widest this processor has.
FillRow fill_row() noexcept;

}  // namespace handsel::costmap::detail
