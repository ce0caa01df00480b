// A trajectory laid out for evaluation: all axes split at the same instants, states at the start of each segment precomputed.
#pragma once

#include <vector>

#include "common/trajectory/lanes.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

class SegmentTable {
 public:
  SegmentTable() = default;
  explicit SegmentTable(const Trajectory&);  ///< allocates; nothing afterwards does

  /// Built piece by piece instead: room for so many segments (allocates), then no allocation up to there.
  void reserve(int axes, int segments);
  int room() const noexcept;  ///< segments that fit without allocation
  void clear(int axes) noexcept;
  /// One more segment, from its states at its start (arrays of axes()).
  void add(double duration, const double* x, const double* v, const double* a, const double* j) noexcept;

  int axes() const noexcept { return axes_; }
  int segments() const noexcept { return static_cast<int>(knots_.size()) - 1; }
  double duration() const noexcept { return knots_.empty() ? 0.0 : knots_.back(); }
  double knot(int k) const noexcept { return knots_[k]; }

  /// Segment that holds t; `hint` is any segment, best the last one used.
  int find(double t, int hint) const noexcept;
  /// State at t, clamped to [0, duration]. `cursor` is kept between calls for speed; 0 at first.
  void evaluate(double t, int& cursor, MotionState3& out) const noexcept;
  /// Velocity, acceleration and jerk at t within segment k; arrays of axes().
  void rates(double t, int k, double* v, double* a, double* j) const noexcept;

 private:
  struct alignas(64) Lane8 {
    double value[detail::kLanes];
  };
  const double* row(int k) const noexcept { return data_.data()->value + static_cast<std::size_t>(k) * 4 * stride_; }
  int axes_{}, stride_{};      // axes, and the next multiple of kLanes
  std::vector<double> knots_;  // segments + 1
  std::vector<Lane8> data_;    // a segment: x of all axes, v, a, j
  const detail::LaneKernels* kernels_{};
};

}  // namespace handsel
