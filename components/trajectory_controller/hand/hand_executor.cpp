#include "components/trajectory_controller/hand/hand_executor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

namespace {
constexpr double kMinor = 0.2;      // of the largest effort: axes with less only hold
constexpr double kSameSpeed = 0.1;  // a limit that changes by less than this fraction does not change a motion under way
}  // namespace

HandExecutor::HandExecutor(const HandSettings& settings, std::vector<int> axes, std::vector<double> lower, std::vector<double> upper,
                           const KinematicLimits& comfort, const KinematicLimits& stop, std::vector<char> sliding)
    : settings_(settings),
      axes_(std::move(axes)),
      lower_(std::move(lower)),
      upper_(std::move(upper)),
      comfort_(comfort),
      stop_(stop),
      fingers_(axes_.size()),
      release_to_(Vector::Zero(static_cast<Eigen::Index>(axes_.size()))),
      release_(settings.pull) {
  for (std::size_t i = 0; i < sliding.size(); ++i)
    if (sliding[i] != 0) fingers_[i].lever = settings.lever;
  settings_.least_contacts = std::min(settings.least_contacts, static_cast<int>(axes_.size()));
}

AxisLimits HandExecutor::limits(std::size_t i, const KinematicLimits& of, double share) const {
  AxisLimits l = limits_of(of, axes_[i]);
  l.velocity *= share;
  return l;
}

void HandExecutor::reset(const Vector& robot_position, const Vector& robot_effort) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const double lever = fingers_[i].lever;
    fingers_[i] = {};
    fingers_[i].lever = lever;
    fingers_[i].target = fingers_[i].final = robot_position[axes_[i]];
    fingers_[i].mover.reset(fingers_[i].target);
  }
  phase_ = Phase::hold;
  paused_ = freeing_ = false;
  most_effort_ = 0.0;
  if (robot_effort.size() == robot_position.size())
    for (std::size_t i = 0; i < fingers_.size(); ++i) {
      fingers_[i].effort = robot_effort[axes_[i]];
      most_effort_ = std::max(most_effort_, std::abs(fingers_[i].effort));
    }
  closed_ = most_effort_ > 0.0;
  level_ = closed_ ? 1.0 : 0.0;
  if (closed_) keep_grip();
  release_.disarm();
}

bool HandExecutor::at_rest() const {
  return std::all_of(fingers_.begin(), fingers_.end(), [](const Finger& f) { return f.mover.at_rest(); });
}

void HandExecutor::stop_from(const MotionState3& from) noexcept {
  paused_ = true;
  for (std::size_t i = 0; i < fingers_.size(); ++i)
    fingers_[i].mover.take_over({from.position[axes_[i]], from.velocity[axes_[i]], from.acceleration[axes_[i]]}, limits(i, stop_, 1.0));
}

void HandExecutor::follow(const Vector& robot_position, double dead_band) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    const double measured = std::clamp(robot_position[axes_[i]], lower_[i], upper_[i]);
    const bool there = std::abs(measured - f.mover.target()) <= dead_band * f.lever;
    f.target = f.final = there ? f.mover.target() : measured;
    if (!there) f.mover.go_to(f.target, limits(i, comfort_, 1.0), limits(i, stop_, 1.0));
  }
  phase_ = Phase::hold;
  if (state_ == HandState::moving) state_ = HandState::refused;  // what was begun is not finished any more
  release_.disarm();
}

std::string HandExecutor::accept(const HandCommand& command) {
  if (command.position.size() != static_cast<Eigen::Index>(fingers_.size()))
    return "hand command has " + std::to_string(command.position.size()) + " positions, the hand has " + std::to_string(fingers_.size()) +
           " axes";
  constexpr double kBeyond = 0.02, kMostEffort = 20;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const double p = command.position[static_cast<Eigen::Index>(i)];
    const double beyond = kBeyond * fingers_[i].lever;
    if (!(p >= lower_[i] - beyond && p <= upper_[i] + beyond))
      return "hand axis " + std::to_string(i) + " wanted at " + std::to_string(p) + ", outside [" + std::to_string(lower_[i]) + ", " +
             std::to_string(upper_[i]) + (fingers_[i].lever == 1.0 ? "] rad" : "] m");
  }
  if (command.effort.size() != 0 && command.effort.size() != command.position.size())
    return "hand command must give as many efforts as positions or none";
  for (Eigen::Index i = 0; i < command.effort.size(); ++i) {
    const double most = kMostEffort / fingers_[static_cast<std::size_t>(i)].lever;
    if (!(std::abs(command.effort[i]) <= most))
      return "hand command must give efforts of at most " + std::to_string(most) + (most == kMostEffort ? " Nm" : " N");
  }
  if (command.action == HandAction::release_on_pull) {
    if (!(command.pull_force > 0) || command.pull_force > 100) return "pull_force must be above 0 and at most 100 N";
    release_to_ = command.position;
    release_.arm(command.pull_force);
    return {};
  }
  release_.disarm();
  release_.forget_load();
  for (std::size_t i = 0; i < fingers_.size(); ++i)
    fingers_[i].final = std::clamp(command.position[static_cast<Eigen::Index>(i)], lower_[i], upper_[i]);
  const bool holds = state_ == HandState::grasped;
  start(command.action == HandAction::grasp ? Phase::closing : command.action == HandAction::release ? Phase::releasing : Phase::moving);
  if (command.action != HandAction::grasp || (holds && command.effort.size() == 0)) return {};
  if (!holds) level_ = 0.0;
  most_effort_ = 0.0;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    f.effort = command.effort.size() > 0 ? command.effort[static_cast<Eigen::Index>(i)]
                                         : f.direction * f.share * settings_.squeeze_effort / f.lever;
    most_effort_ = std::max(most_effort_, std::abs(f.effort));
  }
  return {};
}

void HandExecutor::retarget(std::size_t i, double target) noexcept {
  Finger& f = fingers_[i];
  f.target = std::clamp(target, lower_[i], upper_[i]);
  const bool gently = phase_ == Phase::closing || phase_ == Phase::seeking;
  if (paused_) return;
  AxisLimits l = limits(i, phase_ == Phase::regripping ? stop_ : comfort_, gently ? settings_.grasp_speed : 1.0);
  if (phase_ != Phase::regripping) l.velocity *= speed_limit_;
  if (phase_ == Phase::closing) {
    l.velocity *= f.share;
    l.acceleration *= f.share;
    l.jerk *= f.share;
  }
  f.mover.go_to(f.target, l, limits(i, stop_, 1.0));
}

void HandExecutor::limit_speed(double fraction) noexcept {
  if (std::abs(fraction - speed_limit_) <= kSameSpeed * speed_limit_) return;
  // Fingers that close together would not stay together if each of them got faster on its way.
  if (fraction > speed_limit_ && phase_ == Phase::closing && !at_rest()) return;
  speed_limit_ = fraction;
  if (at_rest()) return;
  for (std::size_t i = 0; i < fingers_.size(); ++i) retarget(i, fingers_[i].target);
}

void HandExecutor::start(Phase phase) {
  phase_ = phase;
  state_ = HandState::moving;
  settled_for_ = lost_for_ = 0.0;
  payload_felt_ = false;
  double longest = 0.0;
  for (const Finger& f : fingers_) longest = std::max(longest, std::abs(f.final - f.mover.state().position));
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    const double way = f.final - f.mover.state().position;
    f.share = longest > 0.0 ? std::max(0.05, std::abs(way) / longest) : 1.0;
    f.direction = phase == Phase::closing && std::abs(way) >= settings_.closing_least * f.lever ? std::copysign(1.0, way) : 0.0;
    f.contact = false;
    f.pressed_for = 0.0;
    if (phase == Phase::closing && !closed_) f.opened = f.mover.state().position;
    retarget(i, f.final);
  }
  closed_ = phase == Phase::closing || (closed_ && phase != Phase::releasing);
}

/// Opens to where the last closing began.
void HandExecutor::free_person() noexcept {
  release_.disarm();
  paused_ = false;
  freeing_ = true;
  for (Finger& f : fingers_) f.final = f.opened;
  start(Phase::releasing);
}

/// What an axis gives to the world [Nm].
double HandExecutor::pressed(const RobotState& robot, std::size_t i) const noexcept {
  const int axis = axes_[i];
  if (axis < robot.external_torque.size()) return -robot.external_torque[axis];
  return axis < robot.effort.size() ? robot.effort[axis] : 0.0;
}

/// An axis that meets something on its way stops there.
void HandExecutor::watch_contacts(const RobotState& robot, double dt) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    if (f.direction == 0.0 || f.contact) continue;
    f.pressed_for = f.direction * pressed(robot, i) > settings_.touch_effort / f.lever ? f.pressed_for + dt : 0.0;
    if (f.pressed_for < settings_.touch_time) continue;
    f.contact = true;
    retarget(i, robot.position[axes_[i]]);
  }
  if (!at_rest()) return;
  phase_ = Phase::seeking;
  for (Finger& f : fingers_) f.target = f.mover.state().position;
}

/// Axes that press on nothing yet go on the way they will push; then all press.
void HandExecutor::seek(const RobotState& robot, double dt) noexcept {
  bool done = true;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    if (f.contact || std::abs(f.effort) < kMinor * most_effort_) continue;
    const double way = std::copysign(1.0, f.effort);
    f.pressed_for = way * pressed(robot, i) > settings_.touch_effort / f.lever ? f.pressed_for + dt : 0.0;
    f.contact = f.pressed_for >= settings_.touch_time ||
                std::abs(f.target - f.final) >= settings_.seek_travel * f.lever * std::abs(f.effort) / most_effort_;
    if (f.contact) continue;
    done = false;
    retarget(i, f.target + dt * settings_.seek_speed * f.lever * f.effort / most_effort_);
    if (f.target <= lower_[i] || f.target >= upper_[i]) f.contact = true;
  }
  if (!done) return;
  phase_ = Phase::squeezing;
  settled_for_ = 0.0;
}

/// Makes the set-points and efforts of this moment those that hold the object.
void HandExecutor::keep_grip() noexcept {
  for (Finger& f : fingers_) {
    f.held = f.target;
    f.grip = std::abs(f.effort) < kMinor * most_effort_ ? 0.0 : std::copysign(1.0, f.effort);
  }
}

void HandExecutor::squeeze(const RobotState& robot, double dt) noexcept {
  level_ = std::min(1.0, level_ + dt / settings_.squeeze_time);
  settled_for_ = level_ >= 1.0 ? settled_for_ + dt : 0.0;
  if (settled_for_ < settings_.settle_time) return;
  keep_grip();
  const bool held = pressing(robot) >= settings_.least_contacts && (!person_near_ || pushes(robot));
  state_ = held ? HandState::grasped : HandState::empty;
  phase_ = Phase::hold;
}

void HandExecutor::judge(const RobotState& robot, double payload, double dt) noexcept {
  if (phase_ == Phase::closing || phase_ == Phase::seeking || phase_ == Phase::squeezing) return;
  if (phase_ == Phase::loosened) return;
  if (phase_ == Phase::hold) {
    if (state_ != HandState::grasped) return;
    if (payload > 2.0 * settings_.lost_payload) payload_felt_ = true;
    lost_for_ = payload_felt_ && payload < settings_.lost_payload ? lost_for_ + dt : 0.0;
    if (lost_for_ >= settings_.lost_time) state_ = HandState::empty;
    return;
  }
  settled_for_ = at_rest() ? settled_for_ + dt : 0.0;
  if (!at_rest() || (phase_ == Phase::regripping && level_ < 1.0)) return;
  if (phase_ == Phase::regripping) {
    state_ = pressing(robot) >= settings_.least_contacts ? HandState::grasped : HandState::empty;
  } else {
    state_ = phase_ == Phase::releasing ? HandState::released : HandState::idle;
    release_.disarm();
  }
  phase_ = Phase::hold;
}

/// Axes that press on what is held.
int HandExecutor::pressing(const RobotState& robot) const noexcept {
  int count = 0;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const Finger& f = fingers_[i];
    if (f.grip != 0.0 && f.grip * pressed(robot, i) > settings_.touch_effort / f.lever) ++count;
  }
  return count;
}

/// A finger that something keeps from what it should push on leaves the others unbalanced: only who else holds the object keeps it there.
bool HandExecutor::pushes(const RobotState& robot) const noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const double effort = std::abs(fingers_[i].effort);
    if (effort <= settings_.squeeze_effort / fingers_[i].lever) continue;
    if (std::copysign(1.0, fingers_[i].effort) * pressed(robot, i) < settings_.least_push * effort) return false;
  }
  return true;
}

void HandExecutor::watch_release(const HandInputs& in, TimePoint now) noexcept {
  if (phase_ != Phase::hold && phase_ != Phase::loosened && phase_ != Phase::releasing) return;
  const RobotState& robot = *in.robot;
  const bool presses = pressing(robot) >= settings_.least_contacts;
  const Grip before = release_.grip(),
             wanted = release_.update({in.force, in.toward, in.person_distance <= settings_.person_range, presses}, now);
  if (wanted == before) {
    if (wanted == Grip::open && !presses) release_.disarm();  // nothing left to close on
    return;
  }
  if (wanted == Grip::loosen) {
    phase_ = Phase::loosened;
    return;
  }
  for (std::size_t i = 0; i < fingers_.size(); ++i)
    fingers_[i].final =
        wanted == Grip::hold ? fingers_[i].held : std::clamp(release_to_[static_cast<Eigen::Index>(i)], lower_[i], upper_[i]);
  start(wanted == Grip::hold ? Phase::regripping : Phase::releasing);
}

/// The efforts of the squeeze follow what the hand does.
void HandExecutor::change_level(double dt) noexcept {
  const double change = dt / settings_.squeeze_time;
  if (phase_ == Phase::regripping) level_ = std::min(1.0, level_ + change);
  if (phase_ == Phase::loosened) level_ = std::max(std::min(level_, settings_.loosen_share), level_ - change);
  if (phase_ == Phase::releasing || phase_ == Phase::moving) level_ = std::max(0.0, level_ - change);
}

/// What was released may still be hooked on a finger while it is drawn away.
void HandExecutor::give_way(const RobotState& robot, double dt) noexcept {
  if (phase_ != Phase::hold || state_ != HandState::released || settings_.yield_speed <= 0) return;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const Finger& f = fingers_[i];
    const double push = -pressed(robot, i);
    if (std::abs(push) > settings_.yield_effort / f.lever)
      retarget(i, f.target + std::copysign(dt * settings_.yield_speed * f.lever, push));
  }
}

void HandExecutor::step(const HandInputs& in, double dt, TimePoint now, MotionState3& out) noexcept {
  const RobotState& robot = *in.robot;
  if (in.new_state) person_near_ = in.person_distance <= settings_.person_range;
  // In Hold and above nothing is sure about where people are.
  const bool alone = in.may_move && !person_near_ && !release_.armed();
  if (in.new_state && alone && state_ == HandState::grasped) release_.bear(in.force, now);
  if (in.clamped && person_near_ && closed_) free_person();
  if (phase_ != Phase::releasing) freeing_ = false;
  if (!in.may_move && !paused_ && !freeing_) {
    paused_ = true;
    for (std::size_t i = 0; i < fingers_.size(); ++i) fingers_[i].mover.stop(limits(i, in.stop ? stop_ : comfort_, 1.0));
  } else if (in.may_move && paused_ && at_rest()) {  // from the middle of a stop the gentle limits might not end inside the bounds
    paused_ = false;
    for (std::size_t i = 0; i < fingers_.size(); ++i) retarget(i, fingers_[i].target);
  }
  if (!paused_) {
    if (phase_ == Phase::closing) watch_contacts(robot, dt);
    if (phase_ == Phase::seeking) seek(robot, dt);
    if (phase_ == Phase::squeezing) squeeze(robot, dt);
    change_level(dt);
    if (release_.armed() && in.new_state) watch_release(in, now);
    judge(robot, in.payload, dt);
    give_way(robot, dt);
  }
  advance(dt, out);
}

void HandExecutor::advance(double dt, MotionState3& out) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const AxisState& s = fingers_[i].mover.step(dt);
    out.position[axes_[i]] = s.position;
    out.velocity[axes_[i]] = s.velocity;
    out.acceleration[axes_[i]] = s.acceleration;
  }
}

}  // namespace handsel::trajectory_controller
