// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/segment_table.hpp"

#include <algorithm>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/min_time.hpp"

namespace handsel {

namespace {

int stride_of(int axes) {
  return (axes + detail::kBatchAxes - 1) / detail::kBatchAxes * detail::kBatchAxes;
}

}  // namespace

SegmentTable::SegmentTable(const Trajectory& trajectory)
    : axes_(trajectory.size()), stride_(stride_of(axes_)), kernels_(&detail::batch_kernels()) {
  const Trajectory alike = split_alike(trajectory);
  const std::size_t count = alike.axes.empty() ? 0 : alike.axes[0].segments.size();
  knots_.assign(1, 0.0);
  for (std::size_t k = 0; k < count; ++k)
    knots_.push_back(knots_.back() + alike.axes[0].segments[k].duration);
  if (count == 0) knots_.push_back(0.0);
  data_.assign(
      std::max<std::size_t>(count, 1) * 4 * static_cast<std::size_t>(stride_) / detail::kBatchAxes,
      detail::BatchRow{});
  for (int i = 0; i < axes_; ++i) {
    AxisState s = alike.axes[i].start;
    for (std::size_t k = 0; k < std::max<std::size_t>(count, 1); ++k) {
      double* row = data_.data()->value + k * 4 * static_cast<std::size_t>(stride_);
      row[i] = s.position;
      row[stride_ + i] = s.velocity;
      row[2 * stride_ + i] = s.acceleration;
      if (count == 0) break;
      const Segment& g = alike.axes[i].segments[k];
      row[3 * stride_ + i] = g.jerk;
      s = advanced(s, g.duration, g.jerk);
    }
  }
}

void SegmentTable::reserve(int axes, int segments) {
  knots_.reserve(static_cast<std::size_t>(segments) + 1);
  data_.reserve(static_cast<std::size_t>(segments) * 4 * static_cast<std::size_t>(stride_of(axes)) /
                detail::kBatchAxes);
}

int SegmentTable::room() const noexcept {
  if (axes_ == 0 || knots_.capacity() == 0) return 0;
  return static_cast<int>(
      std::min(knots_.capacity() - 1,
               data_.capacity() * detail::kBatchAxes / (4 * static_cast<std::size_t>(stride_))));
}

void SegmentTable::clear(int axes) noexcept {
  axes_ = axes;
  stride_ = stride_of(axes);
  kernels_ = &detail::batch_kernels();
  knots_.clear();
  knots_.push_back(0.0);
  data_.clear();
}

void SegmentTable::add(double duration, const double* x, const double* v, const double* a,
                       const double* j) noexcept {
  knots_.push_back(knots_.back() + duration);
  data_.resize(data_.size() + 4 * static_cast<std::size_t>(stride_) / detail::kBatchAxes,
               detail::BatchRow{});
  double* row = data_.data()->value + data_.size() * detail::kBatchAxes -
                4 * static_cast<std::size_t>(stride_);
  for (const double* part : {x, v, a, j}) {
    std::copy(part, part + axes_, row);
    row += stride_;
  }
}

int SegmentTable::find(double t, int hint) const noexcept {
  const int last = segments() - 1;
  int k = std::clamp(hint, 0, last);
  if (t >= knots_[k] && t < knots_[k + 1]) return k;
  if (k < last && t >= knots_[k + 1] && t < knots_[k + 2]) return k + 1;
  k = static_cast<int>(std::upper_bound(knots_.begin() + 1, knots_.end() - 1, t) -
                       (knots_.begin() + 1));
  return std::min(k, last);
}

void SegmentTable::evaluate(double t, int& cursor, MotionState3& out) const noexcept {
  if (axes_ == 0) return;
  t = std::clamp(t, 0.0, duration());
  cursor = find(t, cursor);
  kernels_->evaluate(row(cursor), axes_, stride_, t - knots_[static_cast<std::size_t>(cursor)],
                     {out.position.data(), out.velocity.data(), out.acceleration.data()});
}

}  // namespace handsel
