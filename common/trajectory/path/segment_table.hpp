// SPDX-License-Identifier: Apache-2.0
// A trajectory laid out for evaluation: all axes split at the same instants, states at the start of
// each segment precomputed.
#pragma once

#include <vector>

#include "common/trajectory/batch/kernels.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

class SegmentTable {
 public:
  SegmentTable() = default;
  explicit SegmentTable(const Trajectory&);  ///< allocates; nothing afterwards does

  /// Built piece by piece instead: room for so many segments (allocates), then no allocation up to
  /// there.
  void reserve(int axes, int segments);
  int room() const noexcept;  ///< segments that fit without allocation
  /// Removes all segments and sets the number of axes; keeps the memory.
  void clear(int axes) noexcept;
  /// One more segment, from its states at its start (arrays of axes()).
  void add(double duration, const double* x, const double* v, const double* a,
           const double* j) noexcept;

  /// Returns the number of axes.
  int axes() const noexcept { return axes_; }
  /// Returns the number of segments; -1 for a default-constructed table.
  int segments() const noexcept { return static_cast<int>(knots_.size()) - 1; }
  /// Returns the end of the last segment [s].
  double duration() const noexcept { return knots_.empty() ? 0.0 : knots_.back(); }
  /// Returns the start of segment k [s], duration() for k = segments(). Not checked.
  double knot(int k) const noexcept { return knots_[k]; }

  /// Segment that holds t; `hint` is any segment, best the last one used.
  int find(double t, int hint) const noexcept;
  /// State at t, clamped to [0, duration]. `cursor` is kept between calls for speed; 0 at first.
  void evaluate(double t, int& cursor, MotionState3& out) const noexcept;
  /// Velocities, accelerations and jerks at t within segment k; each part stride() long, on 64
  /// bytes.
  void rates(double t, int k, double* out) const noexcept {
    kernels_->rates(row(k), stride_, t - knots_[static_cast<std::size_t>(k)], out);
  }
  /// Returns the jerks of segment k, one an axis [rad/s^3]. Not checked.
  const double* jerks(int k) const noexcept {
    return row(k) + 3 * static_cast<std::size_t>(stride_);
  }
  /// Returns axes() rounded up to a multiple of detail::kBatchAxes.
  int stride() const noexcept { return stride_; }

 private:
  const double* row(int k) const noexcept {
    return data_.data()->value + static_cast<std::size_t>(k) * 4 * stride_;
  }
  int axes_{}, stride_{};               // axes, and the next multiple of kBatchAxes
  std::vector<double> knots_;           // segments + 1
  std::vector<detail::BatchRow> data_;  // a segment: x of all axes, v, a, j
  const detail::BatchKernels* kernels_{};
};

}  // namespace handsel
