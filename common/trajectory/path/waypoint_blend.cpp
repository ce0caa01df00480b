// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/waypoint_blend.hpp"

#include <algorithm>
#include <bit>

#include "common/trajectory/three_segment.hpp"

namespace handsel::detail {

namespace {
/// Integrates one of the two motions of a blend from a state by its jerks.
void carry(const Blend& blend, AxisState s, Blend::Motion& m) noexcept {
  for (int k = 0; k <= blend.count; ++k) {
    m.velocity[k] = s.velocity;
    m.acceleration[k] = s.acceleration;
    if (k < blend.count) s = advanced(s, blend.duration[k], m.jerk[k]);
  }
}
}  // namespace

SegmentBatch::SegmentBatch(const std::vector<PathSegment>& path_segments,
                           const KinematicLimits& limits)
    : path_segments_(path_segments.size()),
      stride_((static_cast<std::size_t>(limits.velocity.size()) + kBatchAxes - 1) / kBatchAxes *
              kBatchAxes),
      values_((path_segments.size() + 3) * stride_ / kBatchAxes) {
  double* at = values_.data()->value;
  for (const PathSegment& path_segment : path_segments) {
    std::copy(path_segment.step.begin(), path_segment.step.end(), at);
    at += stride_;
  }
  for (const Eigen::VectorXd* all : {&limits.velocity, &limits.acceleration, &limits.jerk}) {
    std::transform(all->begin(), all->end(), at, [](double x) { return 1 / x; });
    at += stride_;
  }
}

WaypointBlend::WaypointBlend(const std::vector<PathSegment>& path_segments, std::size_t first,
                             const SegmentBatch& batch, const KinematicLimits& limits)
    : a_(path_segments[first]),
      b_(path_segments[first + 1]),
      step_a_(batch.step(first)),
      step_b_(batch.step(first + 1)),
      inverse_(batch.inverse_limits()),
      limits_(limits),
      axes_(static_cast<int>(a_.from.size())),
      stride_(batch.stride()) {
  if (a_.zones.empty() && b_.zones.empty()) return;
  scaled_.resize(static_cast<std::size_t>(3 * stride_ / kBatchAxes));
  std::copy(inverse_, inverse_ + 3 * stride_, scaled_.data()->value);
}

void WaypointBlend::keep_scale(double before, double after) noexcept {
  if (a_.zones.empty() && b_.zones.empty()) return;
  const LimitScale scale = a_.scale(a_.duration - before, a_.duration).lower(b_.scale(0, after));
  if (scale == scale_) return;
  scale_ = scale;
  double* to = scaled_.data()->value;
  const double* from = inverse_;
  for (const double factor : {scale.velocity, scale.acceleration, scale.jerk})
    for (int i = 0; i < stride_; ++i) *to++ = *from++ / factor;
}

void WaypointBlend::place(double before, double after) noexcept {
  keep_scale(before, after);
  left_ = a_.path_state(a_.duration - before);
  joined_ = b_.path_state(after);
}

double WaypointBlend::min_duration() noexcept {
  BatchArray zero{}, v, a, xf, vf, af, V{}, A{}, J{};
  AxisBatch block;
  double min_duration = 0;
  for (int first = 0; first < axes_; first += kBatchAxes) {
    const int here = std::min(kBatchAxes, axes_ - first);
    for (int i = 0; i < kBatchAxes; ++i) {
      const double wa = step_a_[first + i], wb = step_b_[first + i];
      v[i] = wa * left_.velocity;
      a[i] = wa * left_.acceleration;
      xf[i] = wa * (1 - left_.position) + wb * joined_.position;
      vf[i] = wb * joined_.velocity;
      af[i] = wb * joined_.acceleration;
    }
    for (int i = 0; i < here; ++i) {
      V[i] = scale_.velocity * limits_.velocity[first + i];
      A[i] = scale_.acceleration * limits_.acceleration[first + i];
      J[i] = scale_.jerk * limits_.jerk[first + i];
    }
    const std::uint32_t odd =
        batch_kernels().prepare({zero, v, a, xf, vf, af, V, A, J}, 0, here, block);
    min_duration = std::max(min_duration, *std::max_element(block.minimum, block.minimum + here));
    for (std::uint32_t left = odd; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      AxisProblem problem;
      if (problem.init({0, v[i], a[i]}, {xf[i], vf[i], af[i]}, {V[i], A[i], J[i]}) !=
          AxisOutcome::ok)
        return -1;
      min_duration = std::max(min_duration, problem.minimum());
    }
  }
  return min_duration;
}

double WaypointBlend::three_excess(double duration, double enough) noexcept {
  const auto a = three_segment(left_, {1, 0, 0}, duration),
             b = three_segment({0, 0, 0}, joined_, duration);
  blend_.count = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    blend_.duration[k] = a[k].duration;
    blend_.a.jerk[k] = a[k].jerk;
    blend_.b.jerk[k] = b[k].jerk;
  }
  from_ = left_;
  carry(blend_, left_, blend_.a);
  carry(blend_, {}, blend_.b);
  return excess(enough);
}

double WaypointBlend::overlap_excess(double shared, double enough) noexcept {
  AxisProfile p, q;
  a_.part(a_.duration - shared, a_.duration, p);
  b_.part(0, shared, q);
  if (p.count + q.count > Blend::kSegments) return enough + 1;
  keep_scale(shared, shared);
  blend_.count = 0;
  double left_p = p.segments[0].duration, left_q = q.segments[0].duration;
  for (int i = 0, k = 0; i < p.count && k < q.count;) {
    const double t = std::min(left_p, left_q);
    if (t > 0) {
      blend_.duration[blend_.count] = t;
      blend_.a.jerk[blend_.count] = p.segments[static_cast<std::size_t>(i)].jerk;
      blend_.b.jerk[blend_.count++] = q.segments[static_cast<std::size_t>(k)].jerk;
    }
    if ((left_p -= t) <= 0 && ++i < p.count)
      left_p = p.segments[static_cast<std::size_t>(i)].duration;
    if ((left_q -= t) <= 0 && ++k < q.count)
      left_q = q.segments[static_cast<std::size_t>(k)].duration;
  }
  from_ = a_.path_state(a_.duration - shared);
  carry(blend_, from_, blend_.a);
  carry(blend_, {}, blend_.b);
  return excess(enough);
}

double WaypointBlend::excess(double enough) const noexcept {
  return batch_kernels().blend_ratio(blend_, step_a_, step_b_,
                                     scaled_.empty() ? inverse_ : scaled_.data()->value, stride_,
                                     1 + enough) -
         1;
}

void WaypointBlend::add_to(Trajectory& out) const {
  for (int i = 0; i < axes_; ++i) {
    for (int k = 0; k < blend_.count; ++k) {
      out.axes[static_cast<std::size_t>(i)].segments.push_back(
          {blend_.duration[k], step_a_[i] * blend_.a.jerk[k] + step_b_[i] * blend_.b.jerk[k]});
    }
  }
}

Trajectory WaypointBlend::piece() const {
  Trajectory out;
  for (int i = 0; i < axes_; ++i) out.axes.push_back({a_.state(from_, i), {}});
  add_to(out);
  return out;
}

}  // namespace handsel::detail
