// At rest: giving way to pushes, drawing back from people.
#include <algorithm>
#include <cmath>

#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

/// How the axes move the point nearest to a person straight away from them.
void Controller::aim_away() noexcept {
  constexpr double kLeast = 0.05;  // [m] of lever
  away_.setZero();
  const Vector3 way = nearest_.on_robot - nearest_.on_person;
  if (nearest_.link < 0 || !(way.norm() > 1e-6)) return;
  const auto link = static_cast<std::size_t>(nearest_.link);
  const Vector3 toward = state_.T_world_base.linear().transpose() * way.normalized();
  robot_->forward(set_point_.position, links_);
  const Vector3 lever = state_.T_world_base.inverse() * nearest_.on_robot - links_[link].translation();
  for (int axis : arm_axes_) {
    full_velocity_.setZero();
    full_velocity_[axis] = 1.0;
    link_twists(*robot_, full_velocity_, links_, twists_);
    away_[axis] = (twists_[link].linear + twists_[link].angular.cross(lever)).dot(toward);
  }
  const double most = away_.cwiseAbs().maxCoeff();
  away_ *= most > kLeast ? 1.0 / most : 0.0;
}

/// At rest the arm gives way to who pushes it, axis by axis, until the push ends; and draws back from who comes too near. In an exchange,
/// and while a hand moves, it gives way to free what is clamped, only.
void Controller::step_yield(TimePoint now) noexcept {
  constexpr double kAhead = 0.5;  // [s] of motion a target lies ahead
  const bool hands_rest = std::none_of(hands_.begin(), hands_.end(), [](const Hand& h) { return h.executor.state() == HandState::moving; });
  const bool may = arm_ == Arm::standing && !rejoin_ && !settings_.dry_run && verdict_.mode < Mode::fault && follows() &&
                   settings_.yield_speed > 0.0 && ((exchanging_.empty() && hands_rest) || touch_ == Contact::clamped);
  // Each new demand for rest is answered by rest first; a push that lasts then moves the arm again.
  constexpr std::uint32_t kHeld = 1U;  // Hold or Stop itself: the bit of no cause
  constexpr std::uint32_t kSilence = bit(Cause::robot_state_silent) | bit(Cause::human_state_silent);
  constexpr std::uint32_t kDemands = kSilence | bit(Cause::drive_not_enabled) | bit(Cause::awaits_person);
  // A contact ends the permission as well, so the word of the supervisor counts.
  const std::uint32_t always = gate_.allowed() ? kHeld : kHeld | bit(Cause::no_go);
  const std::uint32_t demands = verdict_.mode >= Mode::hold ? always | (verdict_.causes & kDemands) : 0U;
  if ((demands & ~rest_demands_) != 0) yield_waits_ = true;
  rest_demands_ = demands;
  if (at_rest()) yield_waits_ = false;
  const bool pushed = may && !yield_waits_ && contact_.pushed() && (verdict_.causes & (bit(Cause::robot_state_silent))) == 0;
  constexpr double kLeastShare = 0.1;  // that the guard must allow
  retreating_ = may && !pushed && verdict_.mode < Mode::hold && settings_.retreat_reach > 0.0 && !attention_silent(now) &&
                advice_.speed_factor < 0.0 && nearest_.link >= 0;
  if (retreating_ && cycles_ % kYieldEvery == 0) aim_away();
  const double share = retreating_ && retreat_share_ >= kLeastShare ? retreat_share_ : 0.0;
  const bool wanted = pushed || share > 0.0;
  if (wanted && !yielding_ && at_rest()) {
    yield_from_ = set_point_.position;
    yielding_ = true;
  }
  if (!yielding_) return;
  bool resting = true;
  for (std::size_t i = 0; i < arm_axes_.size(); ++i) {
    const int axis = arm_axes_[i];
    AxisMover& mover = movers_[static_cast<std::size_t>(axis)];
    const double push = pushed ? contact_.push(i) : 0.0, beyond = std::abs(push) / settings_.contact.yield_torque - 1.0;
    const double wish = pushed ? std::copysign(std::clamp(beyond, 0.0, 1.0), push) : share * away_[axis];
    if (arm_ == Arm::standing && wish == 0.0) {
      if (!mover.at_rest()) mover.stop(limits_of(robot_->stop_limits(), axis));
    } else if (arm_ == Arm::standing && cycles_ % kYieldEvery == 0) {
      const double reach = pushed ? settings_.yield_reach : settings_.retreat_reach;
      AxisLimits limits = limits_of(robot_->comfort_limits(), axis);
      limits.velocity = std::clamp(settings_.yield_speed * std::abs(wish), 1e-3, limits.velocity);
      const Axis& bounds = robot_->axes()[static_cast<std::size_t>(axis)];
      double target = std::clamp(mover.state().position + std::copysign(kAhead * limits.velocity, wish), yield_from_[axis] - reach,
                                 yield_from_[axis] + reach);
      if (bounds.lower < bounds.upper) target = std::clamp(target, bounds.lower, bounds.upper);
      mover.go_to(target, limits, limits_of(robot_->stop_limits(), axis));
    }
    resting = resting && mover.at_rest();
  }
  if (!wanted && resting) yielding_ = false;
}

}  // namespace handsel::trajectory_controller
