#include "sim/robot_side.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/manipulator.hpp"

namespace handsel::sim {

RobotSide::RobotSide(const RobotModel& model, const Vector& start, const RobotSideSettings& settings)
    : settings_(settings), limits_(model.stop_limits()), position_(start) {
  velocity_ = acceleration_ = effort_ = Vector::Zero(start.size());
  stops_.resize(start.size());
  for (const Manipulator& hand : hands_of(model))
    if (hand.fingers != nullptr) hand_axes_.insert(hand_axes_.end(), hand.fingers->axes.begin(), hand.fingers->axes.end());
}

bool RobotSide::command(const JointCommand& command, double now) {
  const auto n = position_.size();
  if (command.effort.size() != 0 && command.effort.size() != n) return false;
  if (command.position.size() != n || command.velocity.size() != n || command.acceleration.size() != n) return false;
  if (mode_ == DriveMode::protective_stop && at_rest_) {
    const bool continues = (command.position - position_).cwiseAbs().maxCoeff() < settings_.resume_tolerance &&
                           command.velocity.cwiseAbs().maxCoeff() < settings_.resume_tolerance;
    matching_ = continues ? matching_ + 1 : 0;
    if (matching_ >= settings_.resume_count) enable();
  }
  if (mode_ != DriveMode::enabled) return false;
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

void RobotSide::stop(DriveMode mode) {
  if (mode_ == DriveMode::enabled) begin_stop(mode);
  mode_ = mode;
}

void RobotSide::hold(const Vector& position, DriveMode mode) {
  position_ = position;
  velocity_.setZero();
  acceleration_.setZero();
  begin_stop(mode);
}

void RobotSide::enable() {
  mode_ = DriveMode::enabled;
  stopping_ = seen_ = false;
  matching_ = 0;
  velocity_.setZero();
  acceleration_.setZero();
}

void RobotSide::begin_stop(DriveMode mode) {
  mode_ = mode;
  stopping_ = true;
  at_rest_ = false;
  matching_ = 0;
  for (Eigen::Index i = 0; i < position_.size(); ++i) {
    stops_[i].init({position_[i], velocity_[i], acceleration_[i]}, {limits_.velocity[i], limits_.acceleration[i], limits_.jerk[i]});
  }
}

double RobotSide::payload(std::size_t hand) const {
  if (hand == 0) return payload_;
  return hand <= static_cast<std::size_t>(other_payloads_.size()) ? other_payloads_[static_cast<Eigen::Index>(hand) - 1] : 0.0;
}

bool RobotSide::hand_moves() const {
  return std::any_of(hand_axes_.begin(), hand_axes_.end(), [&](int axis) { return std::abs(velocity_[axis]) >= 1e-6; });
}

void RobotSide::step(double now, double dt, bool holding_object) {
  if (mode_ == DriveMode::enabled && seen_ && now - last_ > settings_.max_gap) begin_stop(DriveMode::protective_stop);
  if (stopping_) {
    at_rest_ = true;
    for (Eigen::Index i = 0; i < position_.size(); ++i) {
      const AxisState& s = stops_[i].step(dt);
      position_[i] = s.position;
      velocity_[i] = s.velocity;
      acceleration_[i] = s.acceleration;
      at_rest_ = at_rest_ && stops_[i].finished();
    }
  } else if (!fresh_ && seen_) {
    position_ += dt * velocity_ + dt * dt / 2 * acceleration_;
    velocity_ += dt * acceleration_;
  }
  fresh_ = false;
  if (!settings_.never_releases) return;
  if (holding_object && !clenched_) {
    hand_rest_ = hand_moves() ? 0 : hand_rest_ + dt;
    clenched_ = hand_rest_ > 0.5;
    closed_ = position_;
    squeeze_ = effort_;
  }
  if (clenched_) {
    for (int axis : hand_axes_) position_[axis] = closed_[axis], effort_[axis] = squeeze_[axis], velocity_[axis] = acceleration_[axis] = 0;
  }
}

}  // namespace handsel::sim
