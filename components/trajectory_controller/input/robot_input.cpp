// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/robot_input.hpp"

namespace handsel::trajectory_controller {

bool RobotInput::set(const RobotState& state, TimePoint sampled, Duration age, bool new_writer) {
  const bool fell_silent = state.sequence < state_.sequence && time_.since(sampled) > kGone;
  const bool restarted = time_.received() && (new_writer || fell_silent);
  state_ = state;
  time_.mark(sampled);
  new_state_ = true;
  // Older samples waited while this process was suspended.
  constexpr Duration kFresh = std::chrono::milliseconds(50);
  if (asleep_ && age < kFresh) {
    asleep_ = false;
    ready_ = follows();
  }
  const bool begins = !ready_ || restarted;
  ready_ = true;
  return begins;
}

void RobotInput::begin_cycle(TimePoint now) noexcept {
  constexpr Duration kSleep = std::chrono::milliseconds(100);
  asleep_ = asleep_ || (last_cycle_ < now && now - last_cycle_ > kSleep);
  last_cycle_ = now;
}

bool RobotInput::may_send(TimePoint now, bool at_rest) noexcept {
  asleep_ = asleep_ || (age(now) > kGone && at_rest);
  return !asleep_;
}

}  // namespace handsel::trajectory_controller
