// SPDX-License-Identifier: Apache-2.0
#include "common/robot_side/robot_side.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/manipulator.hpp"

namespace handsel {

namespace {

constexpr double kReached = 1e-10;  // max distance from a set-point at rest [rad]
constexpr double kAtRest = 1e-6;    // max speed of a set-point at rest [rad/s]
// Max speed [rad/s] and acceleration [rad/s^2] of a reference that may rest at once.
constexpr double kMaxRestSpeed = 1e-7, kMaxRestAcceleration = 1e-3;
constexpr const char* kAgain = "; the robot follows again once set-points rest where it is";

Vector bounds(const RobotModel& model, double Axis::*bound) {
  Vector out(model.dof());
  for (int i = 0; i < model.dof(); ++i) out[i] = model.axes()[static_cast<std::size_t>(i)].*bound;
  return out;
}

bool slides(const RobotModel& model, int axis) {
  const auto joint = static_cast<std::size_t>(model.axes()[static_cast<std::size_t>(axis)].joint);
  return model.joints()[joint].kind == JointKind::prismatic;
}

SetpointGateSettings gate_settings(const RobotSideSettings& s) {
  return {.period = s.period, .max_ahead = s.max_ahead, .max_missing = s.max_missing};
}

}  // namespace

RobotSide::RobotSide(const RobotModel& model, const Vector& start,
                     const RobotSideSettings& settings)
    : settings_(settings),
      model_(model),
      limits_(model.stop_limits()),
      gate_(model.guard_limits(), bounds(model, &Axis::lower), bounds(model, &Axis::upper),
            gate_settings(settings)),
      position_(start),
      measured_(start),
      joined_(start) {
  velocity_ = acceleration_ = effort_ = Vector::Zero(start.size());
  stops_.resize(start.size());
  joins_.resize(start.size());
  for (const Manipulator& hand : hands_of(model))
    if (hand.fingers != nullptr)
      hand_axes_.insert(hand_axes_.end(), hand.fingers->axes.begin(), hand.fingers->axes.end());
  tolerance_ = Vector::Constant(start.size(), settings.resume_tolerance);
  for (const int axis : hand_axes_)
    tolerance_[axis] = settings.resume_hand * (slides(model, axis) ? settings.hand_lever : 1.0);
}

bool RobotSide::command(const JointCommand& command, double now, double arrival) {
  const auto n = position_.size();
  if (command.effort.size() != 0 && command.effort.size() != n) return false;
  if (command.position.size() != n || command.velocity.size() != n ||
      command.acceleration.size() != n)
    return false;
  const bool may_resume = mode_ == DriveMode::enabled || mode_ == DriveMode::braked ||
                          mode_ == DriveMode::protective_stop;
  if (reference_ == Reference::stands && may_resume) {
    // A set-point at rest in the same place stays the same one while the reference moves to it.
    const bool same = matching_ > 0 && command.position == joined_ && command.velocity.isZero(0.0);
    matching_ = same || continues(command, kAtRest) ? matching_ + 1 : 0;
    joined_ = command.position;
    const bool may_end = mode_ != DriveMode::protective_stop || in_mode_ >= settings_.min_stop;
    if (may_end && matching_ >= settings_.resume_count && rests() && reached(command)) enable();
  }
  if (reference_ != Reference::follows || !accepted(command, arrival)) return false;
  seen_ = fresh_ = true;
  last_ = now;
  position_ = command.position;
  velocity_ = command.velocity;
  acceleration_ = command.acceleration;
  payload_ = command.payload;
  other_payloads_ = command.other_payloads;
  effort_ = command.effort.size() == n ? command.effort : Vector(Vector::Zero(n));
  return true;
}

/// Returns whether a set-point may be followed; if not, the reference begins to stop, or to move to
/// the position of the first set-points at rest.
bool RobotSide::accepted(const JointCommand& command, double arrival) {
  if (settings_.period <= 0) return true;
  if (!seen_ && !reached(command) && continues(command, settings_.resume_tolerance)) {
    begin_stop(mode_);
    refusal_ = "the robot moves to where the first set-points rest";
    return false;
  }
  SetpointRefusal refusal;
  if (!seen_ && !reached(command)) refusal = {SetpointRefusal::Reason::position_step, -1, 0, 0};
  if (!refusal)
    refusal = gate_.check(command.position, command.velocity, command.acceleration,
                          command.sequence, arrival);
  if (refusal) refuse(refusal);
  return !refusal;
}

void RobotSide::refuse(const SetpointRefusal& refusal) {
  ++refused_;
  if (refusal.reason == SetpointRefusal::Reason::order) return;
  begin_stop(mode_);
  refusal_ = "refused a set-point: " + std::string(name(refusal.reason));
  if (refusal.axis >= 0)
    refusal_ += " of axis " + model_.axes()[static_cast<std::size_t>(refusal.axis)].name;
  if (refusal.bound != 0)
    refusal_ +=
        " is " + std::to_string(refusal.value) + ", the limit is " + std::to_string(refusal.bound);
  refusal_ += kAgain;
}

bool RobotSide::reached(const JointCommand& command) const {
  return (command.position - position_).cwiseAbs().maxCoeff() <= kReached;
}

/// Returns whether the reference may rest from one step to the next, and does not merely pass the
/// position of the set-points.
bool RobotSide::rests() const {
  return velocity_.lpNorm<Eigen::Infinity>() <= kMaxRestSpeed &&
         acceleration_.lpNorm<Eigen::Infinity>() <= kMaxRestAcceleration;
}

/// Returns whether a set-point continues from the present position. A loaded arm sags and a held
/// object bends the fingers: the measured configuration counts as well as the reference.
bool RobotSide::continues(const JointCommand& command, double max_speed) const {
  if (!command.position.allFinite() || !command.velocity.allFinite()) return false;
  for (Eigen::Index i = 0; i < position_.size(); ++i) {
    const double off = std::min(std::abs(command.position[i] - position_[i]),
                                std::abs(command.position[i] - measured_[i]));
    if (off >= tolerance_[i] || std::abs(command.velocity[i]) >= max_speed) return false;
  }
  return true;
}

void RobotSide::stop(DriveMode mode) {
  if (mode_ == DriveMode::enabled) begin_stop(mode);
  enter(mode);
  refusal_.clear();
}

void RobotSide::hold(const Vector& position, DriveMode mode) {
  position_ = position;
  velocity_.setZero();
  acceleration_.setZero();
  begin_stop(mode);
  refusal_.clear();
}

void RobotSide::enter(DriveMode mode) {
  if (mode_ != mode) in_mode_ = 0;
  mode_ = mode;
}

void RobotSide::enable() {
  enter(DriveMode::enabled);
  reference_ = Reference::follows;
  refusal_.clear();
  gate_.restart();
  seen_ = false;
  matching_ = 0;
  velocity_.setZero();
  acceleration_.setZero();
}

void RobotSide::begin_stop(DriveMode mode) {
  enter(mode);
  reference_ = Reference::stops;
  matching_ = 0;
  for (Eigen::Index i = 0; i < position_.size(); ++i) {
    const AxisState s{position_[i], velocity_[i], acceleration_[i]};
    const AxisLimits limits = limits_of(limits_, i);
    // Uses the guard limits if the stop limits would not stop the axis within its bounds.
    stops_[i].init(s,
                   gate_.stops_within_bounds(s, i, limits) ? limits : limits_of(gate_.limits(), i));
  }
}

double RobotSide::payload(std::size_t hand) const {
  if (hand == 0) return payload_;
  return hand <= static_cast<std::size_t>(other_payloads_.size())
             ? other_payloads_[static_cast<Eigen::Index>(hand) - 1]
             : 0.0;
}

void RobotSide::report(ServoReference& out) const {
  out.position = position_;
  out.effort = effort_;
  out.payload = payload_;
  out.other_payloads = other_payloads_;
}

void RobotSide::step_stop(double dt) {
  if (reference_ == Reference::stops) {
    bool rests = true;
    for (Eigen::Index i = 0; i < position_.size(); ++i) {
      const AxisState& s = stops_[i].step(dt);
      position_[i] = s.position;
      velocity_[i] = s.velocity;
      acceleration_[i] = s.acceleration;
      rests = rests && stops_[i].finished();
    }
    if (!rests) return;
    reference_ = Reference::stands;
    for (Eigen::Index i = 0; i < position_.size(); ++i)
      joins_[i] = SetpointFilter({position_[i], 0, 0}, limits_of(limits_, i));
    joined_ = position_;
    return;
  }
  if (matching_ == 0 && velocity_.isZero(0.0)) return;
  for (Eigen::Index i = 0; i < position_.size(); ++i) {
    const double to = matching_ > 0 ? joined_[i] : joins_[i].state().position;
    const AxisState& s = joins_[i].toward({to, 0, 0}, dt);
    position_[i] = s.position;
    velocity_[i] = s.velocity;
    acceleration_[i] = s.acceleration;
  }
}

/// Continues with the previous acceleration as long as the robot can still stop within its limits
/// afterwards.
void RobotSide::extrapolate(double dt) {
  for (Eigen::Index i = 0; i < position_.size() && settings_.period > 0; ++i) {
    const AxisState s = advanced({position_[i], velocity_[i], acceleration_[i]}, dt, 0);
    if (!gate_.check_state(s, i)) continue;
    begin_stop(mode_);
    refusal_ = "no set-point came and axis " + model_.axes()[static_cast<std::size_t>(i)].name +
               " nears a limit" + kAgain;
    return step_stop(dt);
  }
  position_ += dt * velocity_ + dt * dt / 2 * acceleration_;
  velocity_ += dt * acceleration_;
}

void RobotSide::step(double now, double dt) {
  in_mode_ += dt;
  if (reference_ == Reference::follows && seen_ && now - last_ > settings_.max_gap) {
    begin_stop(DriveMode::enabled);
    refusal_ = "no set-point for more than " +
               std::to_string(std::lround(1e3 * settings_.max_gap)) + " ms" + kAgain;
  }
  if (reference_ != Reference::follows) {
    if (!fresh_)
      step_stop(dt);  // otherwise the set-point before the refused one was that of this step
  } else if (!fresh_ && seen_) {
    extrapolate(dt);
  }
  fresh_ = false;
}

}  // namespace handsel
