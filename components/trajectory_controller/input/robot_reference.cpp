// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/robot_reference.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

RobotReference::RobotReference(std::vector<int> axes, int dof, const ReferenceSettings& settings)
    : axes_(std::move(axes)), settings_(settings), seen_(Vector::Zero(dof)) {}

double RobotReference::farthest(const Vector& a, const Vector& b) const noexcept {
  double out = 0.0;
  for (const int axis : axes_) out = std::max(out, std::abs(a[axis] - b[axis]));
  return out;
}

bool RobotReference::reported(const RobotState& state) const noexcept {
  return state.reference.position.size() == seen_.size() && state.position.size() == seen_.size() &&
         farthest(state.reference.position, state.position) < settings_.bent;
}

void RobotReference::update(const RobotState& state, const Vector& set_point,
                            bool follows) noexcept {
  stale_ = false;
  if (!reported(state)) {
    state_ = State::unknown;
    return;
  }
  const bool rests = seen_ == state.reference.position;
  seen_ = state.reference.position;
  if (!rests)
    state_ = follows ? State::followed : State::moving;
  else if (!follows || farthest(state.reference.position, set_point) > settings_.apart)
    state_ = State::resting;
  else if (state_ != State::resting)
    state_ = State::followed;
}

}  // namespace handsel::trajectory_controller
