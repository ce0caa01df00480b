// The last look at every set-point: inside the limits, with a checked stop behind it, where a live source looks.
#include <algorithm>
#include <cmath>

#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

void Controller::check_last() noexcept {
  bool arm = false, hand = false, head = false;
  for (Eigen::Index i = 0; i < next_.position.size(); ++i) {
    if (acceptable(set_point_, next_, i, robot_->guard_limits(), settings_.period)) continue;
    const Part part = part_[static_cast<std::size_t>(i)];
    (part == Part::arm ? arm : part == Part::hand ? hand : head) = true;
  }
  if (!arm && !hand && !head) return;
  limit_violation_ = true;
  if (arm && (arm_ == Arm::running || rejoin_)) give_up_path();
  follow_checked_stop(arm, hand, head);
}

/// The parts named come to rest, each axis by itself, from what was sent last.
void Controller::follow_checked_stop(bool arm, bool hand, bool head) noexcept {
  if (arm) {
    stop_arm();
    for (int axis : arm_axes_) write(axis, movers_[static_cast<std::size_t>(axis)].step(settings_.period));
  }
  if (hand)
    for (Hand& each : hands_) {
      each.executor.stop_from(set_point_);
      each.executor.advance(settings_.period, next_);
    }
  if (head)
    for (int axis : head_axes_) {
      movers_[static_cast<std::size_t>(axis)].take_over(sent(axis), limits_of(robot_->stop_limits(), axis));
      write(axis, movers_[static_cast<std::size_t>(axis)].step(settings_.period));
    }
}

double Controller::held_payload() const noexcept {
  double mass = 0.0;
  for (const Hand& hand : hands_) mass += hand.payload;
  return mass;
}

/// No set-point that moves the robot leaves without a checked stop behind it: otherwise the next
/// one of the stop checked before is sent.
void Controller::prove_stop(TimePoint now) noexcept {
  if (unproven_shown_ > 0) --unproven_shown_;
  const double age = std::max(0.0, human_seen_.age(now));
  const bool proven = proof_.check(next_, person_capsules_, state_.T_world_base, age, held_payload());
  if (proven || moves_nothing()) return;
  ++unproven_;
  rejoins_in_vain_ = unproven_shown_ > 0 ? rejoins_in_vain_ + (arm_ == Arm::running ? 1 : 0) : 0;
  unproven_shown_ = static_cast<int>(settings_.proof.shown_time / settings_.period);
  if (arm_ == Arm::running && rejoins_in_vain_ > settings_.proof.max_rejoins)
    give_up_path();  // the planner finds another
  else if (arm_ == Arm::running)
    rejoin_ = !cancelled_;
  const auto moves = [&](int axis) { return next_.velocity[axis] != 0.0 || next_.acceleration[axis] != 0.0; };
  const bool hand = std::any_of(hands_.begin(), hands_.end(),
                                [&](const Hand& h) { return std::any_of(h.executor.axes().begin(), h.executor.axes().end(), moves); });
  follow_checked_stop(std::any_of(arm_axes_.begin(), arm_axes_.end(), moves), hand,
                      std::any_of(head_axes_.begin(), head_axes_.end(), moves));
}

/// Sends no set-point from which a stop would lead where no live source looks: the next one of the stop checked before is sent instead.
/// Giving way to a push is allowed: whoever pushes is there. The fingers alone are no reason: Hold stops them.
void Controller::keep_observed(TimePoint now) noexcept {
  constexpr int kEvery = 10;  // cycles, at rest
  if (!proof_.moving() && cycles_ % kEvery != 0) return;
  blind_ = !stop_space_.observes_stops(next_.position, state_.T_world_base, std::max(0.0, human_seen_.age(now)));
  if (!blind_ || !follows() || moves_nothing() || settings_.dry_run) return;
  if (yielding_ && !retreating_) return;
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
