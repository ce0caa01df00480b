// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/reflex_arm.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::drivers {

namespace {
constexpr int kGripperPeriod = 50;     // cycles between two commands to the gripper
constexpr double kWidthStep = 0.0005;  // min change of a commanded width [m]
}  // namespace

double velocity_toward_end(double position, double end, double max_velocity, double deceleration) {
  return std::min(max_velocity, std::sqrt(2.0 * deceleration * std::max(0.0, end - position)));
}

ReflexArm::ReflexArm(const RobotModel& model, std::vector<int> arm_axes, ReflexLink& link,
                     const ReflexSettings& settings)
    : link_(link), settings_(settings), core_(model, std::move(arm_axes), settings.common) {
  measured_.position = measured_.velocity = measured_.effort = measured_.external_torque =
      Vector::Zero(model.dof());
}

bool ReflexArm::follow(const JointCommand& command, double now) {
  const RobotModel& model = core_.model();
  if (core_.following() && command.position.size() == model.dof() &&
      command.velocity.size() == model.dof()) {
    for (int axis : core_.arm_axes()) {
      const Axis& bounds = model.axes()[static_cast<std::size_t>(axis)];
      const double q = command.position[axis], v = command.velocity[axis],
                   max_velocity = model.guard_limits().velocity[axis];
      const double allowed =
          settings_.limit_ratio *
          (v > 0 ? velocity_toward_end(q, bounds.upper, max_velocity, settings_.joint_deceleration)
                 : velocity_toward_end(-q, -bounds.lower, max_velocity,
                                       settings_.joint_deceleration));
      if (std::abs(v) <= allowed + 1e-6) continue;
      core_.stop("axis " + bounds.name + " at " + std::to_string(q) + " rad may move at " +
                 std::to_string(allowed) + " rad/s, not at " + std::to_string(v));
      return false;
    }
  }
  return core_.command(command, now);
}

void ReflexArm::update_mode() {
  measured_.by_person = true;
  if (state_.mode == ArmMode::emergency_stopped) {
    measured_.mode = DriveMode::emergency_stop;
    measured_.why = "emergency stop";
  } else if (state_.mode == ArmMode::user_stopped) {
    measured_.mode = DriveMode::user_stop;
    measured_.why = "user stop";
  } else if (!state_.powered) {
    measured_.mode = DriveMode::off;
    measured_.why = "the power is off";
  } else if (!state_.brakes_open) {
    measured_.mode = DriveMode::braked;
    measured_.why = "the brakes are closed";
  } else if (state_.mode == ArmMode::reflex) {
    measured_.mode = DriveMode::protective_stop;
    measured_.why = "reflex: " + state_.error;
  } else {
    measured_.by_person = false;
    const bool silent = lost_ >= settings_.lost_cycles;
    measured_.mode = silent ? DriveMode::braked : DriveMode::enabled;
    measured_.why = silent ? "the arm's controller is silent" : "";
  }
}

void ReflexArm::cycle(double now) {
  ReflexState& s = received_;
  const bool came = link_.read(s) && fit({&s.position, &s.velocity, &s.torque, &s.external_torque},
                                         core_.arm_axes());
  if (came) std::swap(state_, received_);  // a state of another arm is ignored
  lost_ = came ? 0 : lost_ + 1;
  if (state_.position.size() == 0 || (lost_ > 0 && lost_ < settings_.lost_cycles))
    return;  // tolerated
  const double dt = lost_ == 0 ? kCycle * count_.passed(state_.cycle) : kCycle;
  const std::vector<int>& axes = core_.arm_axes();
  measured_.position = core_.reference();
  measured_.wrist_wrench = state_.wrist_wrench;
  scatter(state_.position, axes, measured_.position);
  scatter(state_.velocity, axes, measured_.velocity);
  scatter(state_.torque, axes, measured_.effort);
  scatter(state_.external_torque, axes, measured_.external_torque);
  const GripperSettings& g = settings_.gripper;
  if (g.axis >= 0) {
    measured_.position[g.axis] = g.closed + (state_.gripper_width - g.closed_width) /
                                                (g.open_width - g.closed_width) *
                                                (g.open - g.closed);
    measured_.effort[g.axis] = state_.gripper_force;
  }
  update_mode();
  core_.update(measured_, now, dt);
  if (recovering_ && measured_.mode == DriveMode::enabled) {
    recovering_ = false;
    core_.acknowledge();
  }
  commanding_ = core_.following();
  if (settings_.common.dry_run || lost_ > 0 || measured_.mode != DriveMode::enabled) return;
  link_.move_to(gather(core_.reference(), axes));
  if (commanding_ && g.axis >= 0) drive_gripper();
}

void ReflexArm::acknowledge() {
  if (state_.mode == ArmMode::reflex) {
    recovering_ = true;
    if (!settings_.common.dry_run) link_.recover();
  } else {
    core_.acknowledge();
  }
}

double ReflexArm::width_of(double position) const {
  const GripperSettings& g = settings_.gripper;
  return std::clamp(g.closed_width + (position - g.closed) / (g.open - g.closed) *
                                         (g.open_width - g.closed_width),
                    std::min(g.closed_width, g.open_width), std::max(g.closed_width, g.open_width));
}

/// Converts set-points of the axis to widths, and beyond the range of the fingers to forces.
void ReflexArm::drive_gripper() {
  const GripperSettings& g = settings_.gripper;
  if (++gripper_wait_ < kGripperPeriod) return;
  const double wanted = width_of(core_.reference()[g.axis]), beyond = state_.gripper_width - wanted;
  const double force = std::clamp(g.stiffness * beyond, g.min_force, g.max_force);
  const bool closing = beyond > kWidthStep;
  const bool new_width = std::abs(wanted - commanded_width_) > kWidthStep;
  if (!new_width && !(closing && std::abs(force - commanded_force_) > 0.1 * commanded_force_))
    return;
  gripper_wait_ = 0;
  commanded_width_ = wanted;
  commanded_force_ = closing ? force : 0.0;
  if (closing)
    link_.gripper_grasp(wanted, g.speed, force);
  else
    link_.gripper_move(wanted, g.speed);
}

void ReflexArm::set_load(double mass) {
  measured_.payload = mass;
  if (!settings_.common.dry_run) link_.set_load(mass);
}

}  // namespace handsel::drivers
