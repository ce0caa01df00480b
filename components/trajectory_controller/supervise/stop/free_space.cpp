// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/free_space.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

FreeSpace::FreeSpace(const MovingChain& chain, int dof)
    : chain_(chain),
      space_(chain.capsules().size()),
      moved_(static_cast<std::size_t>(dof)),
      position_(Vector::Zero(dof)) {}

void FreeSpace::begin(std::uint64_t revision, const Pose& T_world_base, const Vector& position,
                      double duration) noexcept {
  revision_ = revision;
  T_world_base_ = T_world_base;
  position_ = position;
  duration_ = duration;
}

bool FreeSpace::is_of(std::uint64_t revision, const Pose& T_world_base) const noexcept {
  return revision_ == revision && (T_world_base.matrix() - T_world_base_.matrix()).isZero(0.0);
}

bool FreeSpace::suffices(const StopBounds& bounds, const Vector& position, double duration,
                         double min_speed) noexcept {
  const double grown = std::max(0.0, duration - duration_) * max_person_speed_;
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    moved_[i] = std::abs(position[k] - position_[k]);
  }
  for (std::size_t c = 0; c < space_.size(); ++c) {
    if (bounds.carried(c) + bounds.inner(c) <= min_speed) continue;
    const double moved = chain_.capsules()[c].bound(moved_);
    if (!(bounds.travel(c) + moved + grown <= space_[c])) return false;
  }
  return true;
}

}  // namespace handsel::trajectory_controller
