// SPDX-License-Identifier: Apache-2.0
// A transition between two straight path segments. Whatever the method, an axis moves by step_a *
// alpha(t) + step_b * beta(t), where alpha brings the first segment from where it is left to its
// end and beta the second from its beginning to where it is joined: one pair of scalar motions for
// all axes, whose limits are checked side by side (BatchKernels). Own method, because two scalar
// motions serve all axes; the transitions: chapter section 4.4 and smooth.hpp.
#pragma once

#include <vector>

#include "common/trajectory/batch/kernels.hpp"
#include "common/trajectory/path/path_segment.hpp"

namespace handsel::detail {

/// The steps of all path segments and the limits, laid out for SIMD registers.
class SegmentBatch {
 public:
  SegmentBatch(const std::vector<PathSegment>& path_segments, const KinematicLimits& limits);
  const double* step(std::size_t path_segment) const noexcept {
    return values_.data()->value + path_segment * stride_;
  }
  const double* inverse_limits() const noexcept { return step(path_segments_); }
  int stride() const noexcept { return static_cast<int>(stride_); }

 private:
  std::size_t path_segments_, stride_;
  std::vector<BatchRow> values_;
};

class WaypointBlend {
 public:
  WaypointBlend(const std::vector<PathSegment>& path_segments, std::size_t first,
                const SegmentBatch& batch, const KinematicLimits& limits);

  /// Where the first segment is left, before its end, and the second joined, after its beginning
  /// [s].
  void place(double before, double after) noexcept;
  /// Of a motion between these places, axes alone; negative where there is none [s].
  double min_duration() noexcept;
  /// Excess of three segments of duration / 3; gives up early beyond `enough`.
  double three_excess(double duration, double enough) noexcept;
  /// Excess when the second segment starts `shared` before the first ends.
  double overlap_excess(double shared, double enough) noexcept;
  /// The segments of the transition last tried, added to every axis.
  void add_to(Trajectory&) const;
  /// The same as a trajectory of its own.
  Trajectory piece() const;

 private:
  double excess(double enough) const noexcept;
  /// Keeps the lowest scales of the limits between these places.
  void keep_scale(double before, double after) noexcept;

  const PathSegment &a_, &b_;
  const double *step_a_, *step_b_, *inverse_;
  const KinematicLimits& limits_;
  int axes_, stride_;
  AxisState left_, joined_, from_;
  Blend blend_;
  LimitScale scale_;
  std::vector<BatchRow> scaled_;  // inverse_ for that scale; empty: 1
};

}  // namespace handsel::detail
