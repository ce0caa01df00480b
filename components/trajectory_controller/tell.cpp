// What the controller tells: its status, and what moves now.
#include <algorithm>

#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

/// Returns why the safety state, or the last Go, permits no motion.
std::string Controller::why_no_go() const {
  return gate_.last_refusal() != GoRefusal::none ? text_of(gate_.last_refusal()) : safety_reason_;
}

MotionState Controller::told_motion() const noexcept { return refused_ ? MotionState::refused : motion_; }

StatusKey Controller::status_key() const {
  std::uint64_t hands = 0;
  for (const Hand& hand : hands_) hands = hands << 8 | static_cast<std::uint64_t>(told_hand(hand));
  return {verdict_.mode, go_.epoch, refused_ ? refused_trajectory_ : accepted_trajectory_, last_hand_, told_motion(), hands};
}

ExecutionStatus Controller::status() const {
  ExecutionStatus s;
  s.robot = robot_->name();
  s.mode = verdict_.mode;
  s.causes = verdict_.causes;
  s.epoch = go_.epoch;
  s.trajectory = refused_ ? refused_trajectory_ : accepted_trajectory_;
  s.motion = told_motion();
  if (s.motion == MotionState::finished) {
    s.progress = 1.0;
  } else if (!refused_ && accepted_trajectory_ == pieces_.back().id && runner_.duration() > pieces_.back().begin) {
    const double begin = pieces_.back().begin;
    s.progress = std::clamp((runner_.time() - begin) / (runner_.duration() - begin), 0.0, 1.0);
  }
  s.hand_command = last_hand_;
  if (!hands_.empty()) {
    s.hand = told_hand(hands_.front());
    s.pull = hands_.front().executor.pull();
  }
  for (std::size_t i = 1; i < hands_.size(); ++i) s.other_hands.push_back({hands_[i].group, told_hand(hands_[i])});
  if (!refusal_.empty()) {
    s.reason = refusal_;
    if ((verdict_.causes & bit(Cause::blind)) != 0) s.reason = std::string(name(Cause::blind)) + ": " + why_blind() + "; " + s.reason;
  } else if (verdict_.mode >= Mode::hold) {
    s.reason = std::string(name(verdict_.mode)) + ": " + name(latched_cause_);
    if (latched_cause_ == Cause::cycle_late && !state_.refusal.empty()) s.reason += ": " + state_.refusal;
    if (latched_cause_ == Cause::tracking_error && off_axis_ >= 0)
      s.reason +=
          ": " + robot_->axes()[static_cast<std::size_t>(off_axis_)].name + " was " + std::to_string(off_by_) + " from its set-point";
    if (latched_cause_ == Cause::contact || latched_cause_ == Cause::clamped)
      s.reason += ": felt by " + robot_->axes()[static_cast<std::size_t>(contact_.axis())].name;
    if (latched_cause_ == Cause::forecast_collision && forecast_.collides) s.reason += ": " + forecast_.reason;
    if (latched_cause_ == Cause::blind && (verdict_.causes & bit(Cause::blind)) != 0) s.reason += ": " + why_blind();
    if ((verdict_.causes & bit(Cause::awaits_person)) != 0 && !why_no_go().empty()) s.reason += ": " + why_no_go();
  } else if (const Cause cause = gravest(verdict_.causes); cause != Cause::none) {
    s.reason = name(cause);
    if (cause == Cause::blind) s.reason += ": " + why_blind();
    if (cause == Cause::attention_slow) s.reason += ": " + advice_.reason;
    if (cause == Cause::forecast_collision) s.reason += ": " + forecast_.reason;
  } else if (settings_.dry_run) {
    s.reason = "dry run: no set-point is sent";
  }
  s.cycles = cycles_;
  s.late_cycles = late_cycles_;
  s.limit_share_velocity = shares_.velocity;
  s.limit_share_acceleration = shares_.acceleration;
  s.limit_share_jerk = shares_.jerk;
  s.separation = nearest_.distance;
  s.separation_limit = nearest_.needed;
  s.nearest_on_robot = nearest_.on_robot;
  s.nearest_on_person = nearest_.on_person;
  return s;
}

ActiveTrajectory Controller::active() const {
  ActiveTrajectory a;
  a.robot = robot_->name();
  a.T_world_base = state_.T_world_base;
  a.position = set_point_.position;
  a.velocity = set_point_.velocity;
  a.acceleration = set_point_.acceleration;
  const auto holds = std::find_if(hands_.begin(), hands_.end(), [&](const Hand& h) { return h.group == piece().attachment.hand; });
  const Hand* holder = holds != hands_.end() ? &*holds : hands_.empty() ? nullptr : &hands_.front();
  if (holder == nullptr || holder->executor.state() != HandState::released) a.attachment = piece().attachment;
  if (arm_ != Arm::running) return a;
  a.trajectory = piece().id;
  a.time = runner_.time();
  a.speed_factor = std::clamp(runner_.factor(), -1.0, 1.0);  // rounding
  a.axes = axes_;
  a.rest = runner_.path();
  a.allowed_contacts = piece().allowed_contacts;
  return a;
}

}  // namespace handsel::trajectory_controller
