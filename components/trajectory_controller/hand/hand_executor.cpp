// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/hand/hand_executor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

namespace {
constexpr double kSameSpeed =
    0.1;  // min change of the speed limit, as a fraction, that alters a motion under way

/// Returns why a command cannot be executed, one sentence; empty if it can.
std::string why_not(const HandCommand& command, const Fingers& fingers) {
  constexpr double kBeyond = 0.02, kMaxEffort = 20;
  const auto count = static_cast<Eigen::Index>(fingers.size());
  if (command.position.size() != count)
    return "hand command has " + std::to_string(command.position.size()) +
           " positions, the hand has " + std::to_string(count) + " axes";
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    const double p = command.position[static_cast<Eigen::Index>(i)];
    const double beyond = kBeyond * fingers[i].lever;
    const double lower = fingers.lower(i), upper = fingers.upper(i);
    if (!(p >= lower - beyond && p <= upper + beyond))
      return "hand axis " + std::to_string(i) + " wanted at " + std::to_string(p) + ", outside [" +
             std::to_string(lower) + ", " + std::to_string(upper) +
             (fingers[i].lever == 1.0 ? "] rad" : "] m");
  }
  if (command.effort.size() != 0 && command.effort.size() != command.position.size())
    return "hand command must give as many efforts as positions or none";
  for (Eigen::Index i = 0; i < command.effort.size(); ++i) {
    const double max_effort = kMaxEffort / fingers[static_cast<std::size_t>(i)].lever;
    if (!(std::abs(command.effort[i]) <= max_effort))
      return "hand command must give efforts of at most " + std::to_string(max_effort) +
             (max_effort == kMaxEffort ? " Nm" : " N");
  }
  const bool pulls = command.action == HandAction::release_on_pull;
  if (pulls && (!(command.pull_force > 0) || command.pull_force > 100))
    return "pull_force must be above 0 and at most 100 N";
  return {};
}

/// Returns whether enough axes press on what is held.
bool presses(const Fingers& fingers, const HandSettings& settings,
             const RobotState& robot) noexcept {
  return fingers.count_pressing(robot, settings.touch_effort) >= settings.min_contacts;
}

/// Returns whether the fingers press on an object and hold it without help: no person is near, or
/// all fingers push as planned.
bool holds_alone(const Fingers& fingers, const HandSettings& settings, const RobotState& robot,
                 bool person_near) noexcept {
  return presses(fingers, settings, robot) &&
         (!person_near || fingers.all_push(robot, settings.grip_effort, settings.min_push));
}

}  // namespace

HandExecutor::HandExecutor(const HandSettings& settings, HandAxes hand,
                           const KinematicLimits& comfort, const KinematicLimits& stop)
    : settings_(settings),
      fingers_(std::move(hand), comfort, stop, settings.lever),
      release_to_(Vector::Zero(static_cast<Eigen::Index>(fingers_.size()))),
      release_(settings.pull) {
  settings_.min_contacts = std::min(settings.min_contacts, size());
}

void HandExecutor::reset(const Vector& robot_position, const Vector& robot_effort) noexcept {
  fingers_.reset(robot_position);
  phase_ = Phase::hold;
  paused_ = freeing_ = unsure_ = false;
  max_effort_ = 0.0;
  if (robot_effort.size() == robot_position.size())
    for (std::size_t i = 0; i < fingers_.size(); ++i) {
      fingers_[i].effort = robot_effort[axes()[i]];
      max_effort_ = std::max(max_effort_, std::abs(fingers_[i].effort));
    }
  closed_ = max_effort_ > 0.0;
  level_ = closed_ ? 1.0 : 0.0;
  if (closed_) fingers_.hold_object(settings_.seek_min_effort * max_effort_);
  release_.disarm();
}

bool HandExecutor::is_free() const noexcept {
  return at_rest() && level_ <= 0.0 && state_ != HandState::grasped && phase_ == Phase::hold &&
         !unsure_ && !release_.armed();
}

void HandExecutor::stop_from(const MotionState3& from) noexcept {
  paused_ = true;
  fingers_.stop_from(from);
}

void HandExecutor::follow(const Vector& robot_position, double dead_band) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    const double measured = fingers_.inside(i, robot_position[axes()[i]]);
    const bool there = std::abs(measured - f.mover.target()) <= dead_band * f.lever;
    f.target = f.final = there ? f.mover.target() : measured;
    if (!there) f.mover.go_to(f.target, fingers_.comfort(i), fingers_.stop(i));
  }
  // The interrupted action is not completed, but fingers that still hold an object restore the grip
  // force, and a later pull by a person is still detected.
  const bool grips =
      phase_ == Phase::loosened || phase_ == Phase::unloading || phase_ == Phase::regripping;
  const bool opens = phase_ == Phase::releasing;
  if (state_ == HandState::moving) state_ = HandState::refused;
  phase_ = grips ? Phase::regripping : Phase::hold;
  unsure_ = false;
  settled_for_ = 0.0;
  if (opens)
    release_.disarm();
  else if (release_.armed())
    release_.arm(release_.threshold());
}

std::string HandExecutor::accept(const HandCommand& command) {
  if (std::string reason = why_not(command, fingers_); !reason.empty()) return reason;
  if (command.action == HandAction::release_on_pull) {
    release_to_ = command.position;
    release_.arm(command.pull_force);
    // An action interrupted by a stop does not count against the new command.
    if (state_ == HandState::refused) state_ = closed_ ? HandState::grasped : HandState::idle;
    return {};
  }
  release_.disarm();
  // A hand that grips again, e.g. after a stop while it opened, holds the same object as before;
  // the load is known, so a pull that a person already exerts is detected.
  const bool grips_again = command.action == HandAction::grasp &&
                           (state_ == HandState::refused || state_ == HandState::grasped);
  if (command.action != HandAction::release && !grips_again) release_.forget_load();
  for (std::size_t i = 0; i < fingers_.size(); ++i)
    fingers_[i].final = fingers_.inside(i, command.position[static_cast<Eigen::Index>(i)]);
  const bool holds = state_ == HandState::grasped;
  if (command.action == HandAction::release && level_ > 0.0) {
    phase_ = Phase::unloading;
    state_ = HandState::moving;
    unsure_ = false;
    return {};
  }
  start(command.action == HandAction::grasp     ? Phase::closing
        : command.action == HandAction::release ? Phase::releasing
                                                : Phase::moving);
  if (command.action != HandAction::grasp || (holds && command.effort.size() == 0)) return {};
  if (!holds) level_ = 0.0;
  max_effort_ = 0.0;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    f.effort = command.effort.size() > 0
                   ? command.effort[static_cast<Eigen::Index>(i)]
                   : f.direction * f.speed_ratio * settings_.grip_effort / f.lever;
    max_effort_ = std::max(max_effort_, std::abs(f.effort));
  }
  return {};
}

void HandExecutor::retarget(std::size_t i, double target) noexcept {
  Finger& f = fingers_[i];
  f.target = fingers_.inside(i, target);
  const bool gently =
      phase_ == Phase::closing || phase_ == Phase::seeking || phase_ == Phase::gripping;
  if (paused_) return;
  const bool fast = phase_ == Phase::regripping;
  AxisLimits l = fast ? fingers_.stop(i) : fingers_.comfort(i);
  if (gently) l.velocity *= settings_.grasp_speed;
  if (!fast) l.velocity *= speed_limit_;
  if (phase_ == Phase::closing) {
    l.velocity *= f.speed_ratio;
    l.acceleration *= f.speed_ratio;
    l.jerk *= f.speed_ratio;
  }
  f.mover.go_to(f.target, l, fingers_.stop(i));
}

void HandExecutor::limit_speed(double fraction) noexcept {
  if (std::abs(fraction - speed_limit_) <= kSameSpeed * speed_limit_) return;
  // Fingers that close together would lose their synchronisation if each accelerated while closing.
  if (fraction > speed_limit_ && phase_ == Phase::closing && !at_rest()) return;
  speed_limit_ = fraction;
  if (at_rest()) return;
  for (std::size_t i = 0; i < fingers_.size(); ++i) retarget(i, fingers_[i].target);
}

void HandExecutor::start(Phase phase) {
  phase_ = phase;
  state_ = HandState::moving;
  settled_for_ = lost_for_ = 0.0;
  payload_felt_ = unsure_ = false;
  double farthest = 0.0;
  for (const Finger& f : fingers_)
    farthest = std::max(farthest, std::abs(f.final - f.mover.state().position));
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    const double travel = f.final - f.mover.state().position;
    f.speed_ratio = farthest > 0.0 ? std::max(0.05, std::abs(travel) / farthest) : 1.0;
    const bool closes = std::abs(travel) >= settings_.min_closing * f.lever;
    f.direction = phase == Phase::closing && closes ? std::copysign(1.0, travel) : 0.0;
    f.contact = false;
    f.pressed_for = 0.0;
    if (phase == Phase::closing && !closed_) f.opened = f.mover.state().position;
    retarget(i, f.final);
  }
  closed_ = phase == Phase::closing || phase == Phase::regripping ||
            (closed_ && phase != Phase::releasing);
}

/// Stops an axis that meets a contact.
void HandExecutor::watch_contacts(const RobotState& robot, double dt) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    if (f.direction == 0.0 || f.contact) continue;
    const double met = f.direction * fingers_.pressed(robot, i);
    f.pressed_for = met > settings_.touch_effort / f.lever ? f.pressed_for + dt : 0.0;
    if (f.pressed_for < settings_.touch_time) continue;
    f.contact = true;
    retarget(i, robot.position[axes()[i]]);
  }
  if (!at_rest()) return;
  phase_ = Phase::seeking;
  for (Finger& f : fingers_) f.target = f.mover.state().position;
}

/// Moves axes without contact on in the direction in which they will push. Returns whether each
/// axis has contact or has reached its bound.
bool HandExecutor::seek(const RobotState& robot, double dt) noexcept {
  bool done = true;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    if (f.contact || f.effort == 0.0 ||
        std::abs(f.effort) < settings_.seek_min_effort * max_effort_)
      continue;
    const double met = std::copysign(1.0, f.effort) * fingers_.pressed(robot, i);
    f.pressed_for = met > settings_.touch_effort / f.lever ? f.pressed_for + dt : 0.0;
    const double max_travel = settings_.seek_travel * f.lever * std::abs(f.effort) / max_effort_;
    f.contact = f.pressed_for >= settings_.touch_time || std::abs(f.target - f.final) >= max_travel;
    if (f.contact) continue;
    done = false;
    retarget(i, f.target + dt * settings_.seek_speed * f.lever * f.effort / max_effort_);
    if (f.target <= fingers_.lower(i) || f.target >= fingers_.upper(i)) f.contact = true;
  }
  return done;
}

void HandExecutor::grip(const RobotState& robot, double dt) noexcept {
  const bool sought = seek(robot, dt);
  level_ = std::min(1.0, level_ + dt / settings_.grip_rise_time);
  settled_for_ = sought && level_ >= 1.0 ? settled_for_ + dt : 0.0;
  if (settled_for_ < settings_.settle_time) return;
  fingers_.hold_object(settings_.seek_min_effort * max_effort_);
  // If an obstacle keeps a finger from its contact, the other fingers are unbalanced: only a person
  // who also holds the object keeps it in place.
  const bool holds = holds_alone(fingers_, settings_, robot, person_near_);
  unsure_ = !holds && presses(fingers_, settings_, robot);
  state_ = holds ? HandState::grasped : HandState::empty;
  phase_ = Phase::hold;
  settled_for_ = 0.0;
}

void HandExecutor::check_outcome(const RobotState& robot, double payload, double dt) noexcept {
  if (phase_ == Phase::closing || phase_ == Phase::seeking || phase_ == Phase::gripping) return;
  if (phase_ == Phase::loosened || phase_ == Phase::unloading) return;
  if (phase_ == Phase::hold) {
    if (unsure_) {
      // Fingers that do not push as planned may still hold the object after the person releases it.
      settled_for_ =
          holds_alone(fingers_, settings_, robot, person_near_) ? settled_for_ + dt : 0.0;
      if (settled_for_ >= settings_.settle_time) {
        state_ = HandState::grasped;
        unsure_ = false;
      }
    }
    if (state_ != HandState::grasped) return;
    if (payload > 2.0 * settings_.lost_payload) payload_felt_ = true;
    lost_for_ = payload_felt_ && payload < settings_.lost_payload ? lost_for_ + dt : 0.0;
    if (lost_for_ >= settings_.lost_time) state_ = HandState::empty;
    return;
  }
  settled_for_ = at_rest() ? settled_for_ + dt : 0.0;
  if (!at_rest() || (phase_ == Phase::regripping && level_ < 1.0)) return;
  if (phase_ == Phase::regripping) {
    state_ = presses(fingers_, settings_, robot) ? HandState::grasped : HandState::empty;
  } else {
    state_ = phase_ == Phase::releasing ? HandState::released : HandState::idle;
    release_.disarm();
  }
  phase_ = Phase::hold;
}

void HandExecutor::watch_release(const HandInputs& in, TimePoint now) noexcept {
  if (phase_ != Phase::hold && phase_ != Phase::loosened && phase_ != Phase::releasing) return;
  const RobotState& robot = *in.robot;
  const bool pressing = presses(fingers_, settings_, robot),
             near = in.person_distance <= settings_.person_range;
  const Grip before = release_.grip();
  const Grip wanted = release_.update({in.force, in.toward, near, pressing}, now);
  if (wanted == before) {
    if (wanted == Grip::open && !pressing) release_.disarm();  // nothing left to close on
    return;
  }
  if (wanted == Grip::loosen) {
    phase_ = Phase::loosened;
    return;
  }
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const double open = fingers_.inside(i, release_to_[static_cast<Eigen::Index>(i)]);
    fingers_[i].final = wanted == Grip::hold ? fingers_[i].held : open;
  }
  start(wanted == Grip::hold ? Phase::regripping : Phase::releasing);
}

/// Adapts the grip force to the phase of the hand.
void HandExecutor::change_level(double dt) noexcept {
  const double change = dt / settings_.grip_rise_time;
  if (phase_ == Phase::regripping)
    level_ = std::min(1.0, level_ + change);
  else if (phase_ == Phase::loosened)
    level_ = std::max(std::min(level_, settings_.loosen_fraction), level_ - change);
  else if (phase_ == Phase::unloading || phase_ == Phase::moving || !closed_)
    level_ = std::max(0.0, level_ - change);
  // Fingers that open while they still press would drag the object along.
  if (phase_ == Phase::unloading && level_ <= 0.0) start(Phase::releasing);
}

/// Complies with contact after a release: the object may be hooked on a finger as it is removed.
void HandExecutor::comply(const RobotState& robot, double dt) noexcept {
  if (phase_ != Phase::hold || state_ != HandState::released || settings_.yield_speed <= 0) return;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const Finger& f = fingers_[i];
    const double push = -fingers_.pressed(robot, i);
    if (std::abs(push) > settings_.yield_effort / f.lever)
      retarget(i, f.target + std::copysign(dt * settings_.yield_speed * f.lever, push));
  }
}

void HandExecutor::step(const HandInputs& in, double dt, TimePoint now,
                        MotionState3& out) noexcept {
  const RobotState& robot = *in.robot;
  if (in.new_state) person_near_ = in.person_distance <= settings_.person_range;
  // In Hold and more severe modes the positions of people are uncertain.
  const bool alone = in.may_move && !person_near_ && !release_.armed();
  if (in.new_state && alone && state_ == HandState::grasped) release_.bear(in.force, now);
  if (in.restarts_watch && release_.armed() && phase_ == Phase::hold)
    release_.arm(release_.threshold());
  if (in.clamped && person_near_ && closed_) {  // opens to where the last closing began
    release_.disarm();
    paused_ = false;
    freeing_ = true;
    for (Finger& f : fingers_) f.final = f.opened;
    start(Phase::releasing);
  }
  if (phase_ != Phase::releasing) freeing_ = false;
  // An object that a person takes is released in any case.
  const bool approaches =
      phase_ == Phase::moving || phase_ == Phase::closing || phase_ == Phase::seeking;
  const bool waits = in.too_near && approaches;
  if ((!in.may_move || waits) && !paused_ && !freeing_) {
    paused_ = true;
    fingers_.stop_all(in.stop || waits);
  } else if (in.may_move && !waits && paused_ && at_rest()) {
    // From the middle of a stop, the comfort limits might not end inside the bounds.
    paused_ = false;
    for (std::size_t i = 0; i < fingers_.size(); ++i) retarget(i, fingers_[i].target);
  }
  if (!paused_) {
    if (phase_ == Phase::closing) watch_contacts(robot, dt);
    // A person who feels the fingers releases the object at once: the grip force rises as soon as
    // most of it acts on the object, while other axes still search for contact.
    if (phase_ == Phase::seeking &&
        (seek(robot, dt) ||
         fingers_.fraction_in_contact(settings_.touch_time) >= settings_.grip_fraction)) {
      phase_ = Phase::gripping;
      settled_for_ = 0.0;
    }
    if (phase_ == Phase::gripping) grip(robot, dt);
    change_level(dt);
    if (release_.armed() && in.new_state) watch_release(in, now);
    check_outcome(robot, in.payload, dt);
    comply(robot, dt);
  }
  advance(dt, out);
}

void HandExecutor::advance(double dt, MotionState3& out) noexcept { fingers_.advance(dt, out); }

}  // namespace handsel::trajectory_controller
