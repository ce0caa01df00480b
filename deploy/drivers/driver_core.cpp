// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/driver_core.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::drivers {

bool fit(std::initializer_list<const Vector*> vectors, const std::vector<int>& axes) {
  const auto count = static_cast<Eigen::Index>(axes.size());
  return std::all_of(vectors.begin(), vectors.end(),
                     [count](const Vector* v) { return v->size() == count; });
}

void scatter(const Vector& values, const std::vector<int>& axes, Vector& robot) {
  for (std::size_t i = 0; i < axes.size(); ++i)
    robot[axes[i]] = values[static_cast<Eigen::Index>(i)];
}

Vector gather(const Vector& robot, const std::vector<int>& axes) {
  Vector values(static_cast<Eigen::Index>(axes.size()));
  for (std::size_t i = 0; i < axes.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = robot[axes[i]];
  return values;
}

bool Driver::command(const JointCommand& command, double now) {
  if (!follow(command, now)) return false;
  if (command.payload != load_) set_load(load_ = command.payload);
  return true;
}

int CycleCount::passed(std::uint64_t cycle) {
  const std::uint64_t since = known_ && cycle > at_ ? cycle - at_ : 1;
  at_ = cycle;
  known_ = true;
  return static_cast<int>(std::min<std::uint64_t>(since, 20));
}

DriverCore::DriverCore(const RobotModel& model, std::vector<int> arm_axes,
                       const DriverSettings& settings)
    : model_(model),
      arm_axes_(std::move(arm_axes)),
      settings_(settings),
      side_(model, Vector::Zero(model.dof()), settings.watch),
      reference_(Vector::Zero(model.dof())),
      fading_(arm_axes_.size()) {
  measured_.position = measured_.velocity = measured_.effort = measured_.external_torque =
      reference_;
}

bool DriverCore::command(const JointCommand& command, double now) {
  if (!side_known_ || waits_for_person_ || command.position.size() != reference_.size() ||
      !command.position.allFinite())
    return false;
  const bool followed = side_.follows();
  if (!side_.command(command, now)) {
    if (followed && !side_.follows()) why_ = side_.refusal();
    return false;
  }
  has_followed_ = true;
  return true;
}

void DriverCore::settle() noexcept {
  for (SetpointFilter& f : fading_) f = {};
  commanded_ = {side_.position(), side_.velocity(), side_.acceleration()};
}

void DriverCore::update(const Measured& measured, double now, double dt) {
  const bool was_stopped = !side_known_ || measured_.mode != DriveMode::enabled;
  measured_ = measured;
  if (measured.mode != DriveMode::enabled) {
    waits_for_person_ = waits_for_person_ || (measured.by_person && has_followed_);
    why_ = measured.why;
    side_.hold(measured.position, measured.mode);
    settle();
  } else if (was_stopped) {  // the arm may have moved meanwhile
    side_.hold(measured.position, DriveMode::braked);
    settle();
  }
  side_known_ = true;
  side_.measured(measured.position);
  const bool followed = side_.follows();
  side_.step(now, dt);
  if (followed && !side_.follows()) {
    why_ = side_.refusal();
  }
  follow_set_points(dt);
}

/// Adopts the set-points. The clocks of both sides differ, so a cycle may receive one set-point
/// more or fewer. The deviation from the expected position is added to the difference between
/// reference and set-points, which decays; the reference itself never jumps.
void DriverCore::follow_set_points(double dt) noexcept {
  const KinematicLimits& guard = model_.guard_limits();
  reference_ = side_.position();
  for (std::size_t i = 0; i < arm_axes_.size(); ++i) {
    const int axis = arm_axes_[i];
    const double expected =
        commanded_.position[axis] +
        dt * (commanded_.velocity[axis] + 0.5 * dt * commanded_.acceleration[axis]);
    AxisState off = fading_[i].state();
    off.position += expected - side_.position()[axis];
    AxisLimits limits = limits_of(guard, axis);
    limits.velocity *= settings_.fade_fraction;
    limits.acceleration *= settings_.fade_fraction;
    limits.jerk *= settings_.fade_fraction;
    fading_[i] = SetpointFilter(off, limits);
    reference_[axis] += fading_[i].toward({}, dt).position;
  }
  commanded_ = {side_.position(), side_.velocity(), side_.acceleration()};
}

void DriverCore::hold(const std::string& why) {
  why_ = why;
  side_.hold(measured_.position, DriveMode::braked);
  settle();
  reference_ = side_.position();
}

void DriverCore::start_from(const Vector& position) noexcept {
  for (std::size_t i = 0; i < arm_axes_.size(); ++i) {
    const int axis = arm_axes_[i];
    fading_[i] = SetpointFilter({position[axis] - commanded_.position[axis], 0.0, 0.0},
                                limits_of(model_.guard_limits(), axis));
  }
}

void DriverCore::stop(const std::string& why) {
  why_ = why;
  side_.stop(DriveMode::protective_stop);
}

void DriverCore::acknowledge() {
  if (measured_.mode == DriveMode::enabled) waits_for_person_ = has_followed_ = false;
}

RobotState DriverCore::state(bool commanding) const {
  RobotState s;
  s.robot = model_.name();
  s.sequence = ++sequence_;
  s.T_world_base = settings_.T_world_base;
  s.position = measured_.position;
  s.velocity = measured_.velocity;
  s.effort = measured_.effort;
  side_.report(s.reference);
  s.external_torque = measured_.external_torque;
  s.wrist_wrench = measured_.wrist_wrench;
  s.payload = measured_.payload;
  s.mode = side_.mode();
  s.refusal = side_.refusal();
  s.refused_set_points = side_.refused();
  if (settings_.dry_run) {
    s.position = reference_;
    s.velocity = side_.velocity();
  } else if (s.mode == DriveMode::enabled && !commanding && side_.follows()) {
    s.mode = DriveMode::braked;
  }
  if (!side_known_) s.mode = DriveMode::off;
  return s;
}

std::string DriverCore::trouble() const {
  if (following()) return {};
  if (waits_for_person_ && measured_.mode == DriveMode::enabled)
    return why_ + "; over, waits for a person's acknowledgement";
  return why_;
}

}  // namespace handsel::drivers
