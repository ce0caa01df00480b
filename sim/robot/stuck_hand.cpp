// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/stuck_hand.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {

void StuckHand::apply(double dt, bool holds_object, Reference& reference) {
  constexpr double kMinRestTime = 0.5;    // min time at rest before the hand is stuck [s]
  constexpr double kMaxRestSpeed = 1e-6;  // max speed of an axis at rest [rad/s], [m/s]
  if (holds_object && !stuck_) {
    const auto is_moving = [&](int axis) {
      return std::abs(reference.velocity[axis]) >= kMaxRestSpeed;
    };
    const bool moves = std::any_of(axes_.begin(), axes_.end(), is_moving);
    at_rest_ = moves ? 0 : at_rest_ + dt;
    stuck_ = at_rest_ > kMinRestTime;
    position_ = reference.position;
    effort_ = reference.effort;
  }
  if (!stuck_) return;
  for (const int axis : axes_) {
    reference.position[axis] = position_[axis];
    reference.effort[axis] = effort_[axis];
    reference.velocity[axis] = reference.acceleration[axis] = 0;
  }
}

}  // namespace handsel::sim
