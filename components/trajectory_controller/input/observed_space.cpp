// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/observed_space.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

namespace {

bool holds(const Box& outer, const Box& inner) noexcept {
  return (inner.low.array() >= outer.low.array()).all() &&
         (inner.high.array() <= outer.high.array()).all();
}

bool apart(const Box& a, const Box& b) noexcept {
  return (a.low.array() >= b.high.array()).any() || (b.low.array() >= a.high.array()).any();
}

}  // namespace

void ObservedSpace::set(const std::vector<SourceView>& views) noexcept {
  count_ = 0;
  for (const SourceView& view : views)
    if (view.live && count_ < kMaxViews)
      views_[count_++] = {{view.low, view.high}, std::max(0.0, view.age)};
}

bool ObservedSpace::any(double since) const noexcept {
  return std::any_of(views_.begin(), views_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const View& view) { return counts(view, since); });
}

bool ObservedSpace::one_contains(const Box& box, double since) const noexcept {
  return std::any_of(views_.begin(), views_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const View& view) { return counts(view, since) && holds(view.box, box); });
}

bool ObservedSpace::contains(const Box& box, double since) const noexcept {
  int pieces = kMaxPieces;
  return one_contains(box, since) || contains(box, 0, since, pieces);
}

/// Returns whether the views from index `from` on contain the box: the parts outside of the first
/// view that meets the box are cut off, and the later views must contain them.
bool ObservedSpace::contains(Box box, std::size_t from, double since, int& pieces) const noexcept {
  if (--pieces < 0) return false;
  for (std::size_t i = from; i < count_; ++i) {
    const Box& view = views_[i].box;
    if (!counts(views_[i], since) || apart(view, box)) continue;
    for (Eigen::Index k = 0; k < 3; ++k) {
      Box rest = box;
      if (box.low[k] < view.low[k]) {
        rest.high[k] = box.low[k] = view.low[k];
        if (!contains(rest, i + 1, since, pieces)) return false;
        rest.high[k] = box.high[k];
      }
      if (box.high[k] > view.high[k]) {
        rest.low[k] = box.high[k] = view.high[k];
        if (!contains(rest, i + 1, since, pieces)) return false;
      }
    }
    return true;
  }
  return false;
}

}  // namespace handsel::trajectory_controller
