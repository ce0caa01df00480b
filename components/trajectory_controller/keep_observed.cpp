// No arm moves blind: what the controller does where no live source looks.
#include <algorithm>

#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

/// Sends no set-point from which a stop would lead where no live source looks: the next one of the stop checked before is sent instead.
/// Giving way to a push is allowed: whoever pushes is there. The fingers alone are no reason: Hold stops them.
void Controller::keep_observed(TimePoint now) noexcept {
  constexpr int kEvery = 10;  // cycles, at rest
  if (!proof_.moving() && cycles_ % kEvery != 0) return;
  blind_ = !stop_space_.observes_stops(next_.position, state_.T_world_base, std::max(0.0, human_seen_.age(now)));
  const bool executed = state_.mode == DriveMode::enabled && state_.refusal.empty() && !settings_.dry_run;
  if (!blind_ || !executed || (yielding_ && !retreating_)) return;
  const auto moves = [&](int axis) { return next_.velocity[axis] != 0.0 || next_.acceleration[axis] != 0.0; };
  const bool arm = std::any_of(arm_axes_.begin(), arm_axes_.end(), moves);
  if (arm && arm_ == Arm::running) rejoin_ = !cancelled_;
  follow_checked_stop(arm, false, std::any_of(head_axes_.begin(), head_axes_.end(), moves));
}

std::string Controller::why_blind() const {
  const int link = stop_space_.link();
  return trajectory_controller::why_blind(people_, link < 0 ? "" : robot_->links()[static_cast<std::size_t>(link)].name);
}

}  // namespace handsel::trajectory_controller
