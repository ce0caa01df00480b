// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/stop_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

StopBounds::StopBounds(const MovingChain& chain, int dof)
    : chain_(chain),
      travel_(chain.capsules().size()),
      carried_(travel_),
      inner_(travel_),
      axis_travel_(static_cast<std::size_t>(dof)),
      other_axis_travel_(axis_travel_),
      axis_speed_(axis_travel_) {}

void StopBounds::set(const StopPlan& one, const StopPlan& other) noexcept {
  for (std::vector<double>* by_axis : {&axis_travel_, &other_axis_travel_, &axis_speed_})
    std::fill(by_axis->begin(), by_axis->end(), 0.0);
  for (int k = 0; k < one.count(); ++k) {
    const AxisStop &a = one[k], &b = other[k];
    const auto axis = static_cast<std::size_t>(a.axis);
    axis_travel_[axis] = a.travel;
    other_axis_travel_[axis] = b.travel;
    axis_speed_[axis] = std::max(a.max_speed, b.max_speed);
  }
  for (std::size_t c = 0; c < travel_.size(); ++c) {
    const ChainCapsule& capsule = chain_.capsules()[c];
    travel_[c] = std::max(capsule.bound(axis_travel_), capsule.bound(other_axis_travel_));
    carried_[c] = capsule.carried_bound(axis_speed_);
    inner_[c] = capsule.inner_bound(axis_speed_);
  }
}

double StopBounds::inner_travel(std::size_t capsule) const noexcept {
  const ChainCapsule& of = chain_.capsules()[capsule];
  return std::max(of.inner_bound(axis_travel_), of.inner_bound(other_axis_travel_));
}

}  // namespace handsel::trajectory_controller
