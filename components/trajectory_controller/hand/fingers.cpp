// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/hand/fingers.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

Fingers::Fingers(HandAxes hand, const KinematicLimits& comfort, const KinematicLimits& stop,
                 double lever)
    : hand_(std::move(hand)), comfort_(comfort), stop_(stop), fingers_(hand_.axes.size()) {
  for (std::size_t i = 0; i < hand_.sliding.size(); ++i)
    if (hand_.sliding[i] != 0) fingers_[i].lever = lever;
}

double Fingers::inside(std::size_t i, double position) const noexcept {
  return std::clamp(position, hand_.lower[i], hand_.upper[i]);
}

AxisLimits Fingers::comfort(std::size_t i) const noexcept {
  return limits_of(comfort_, hand_.axes[i]);
}

AxisLimits Fingers::stop(std::size_t i) const noexcept { return limits_of(stop_, hand_.axes[i]); }

void Fingers::reset(const Vector& robot_position) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& f = fingers_[i];
    const double lever = f.lever;
    f = {};
    f.lever = lever;
    f.target = f.final = robot_position[hand_.axes[i]];
    f.mover.reset(f.target);
  }
}

void Fingers::stop_from(const MotionState3& from) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const int axis = hand_.axes[i];
    const AxisState state{from.position[axis], from.velocity[axis], from.acceleration[axis]};
    fingers_[i].mover.take_over(state, stop(i));
  }
}

void Fingers::stop_all(bool fast) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i)
    fingers_[i].mover.stop(fast ? stop(i) : comfort(i));
}

void Fingers::advance(double dt, MotionState3& out) noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const AxisState& s = fingers_[i].mover.step(dt);
    const int axis = hand_.axes[i];
    out.position[axis] = s.position;
    out.velocity[axis] = s.velocity;
    out.acceleration[axis] = s.acceleration;
  }
}

bool Fingers::at_rest() const noexcept {
  return std::all_of(fingers_.begin(), fingers_.end(),
                     [](const Finger& f) { return f.mover.at_rest(); });
}

double Fingers::pressed(const RobotState& robot, std::size_t i) const noexcept {
  const int axis = hand_.axes[i];
  if (axis < robot.external_torque.size()) return -robot.external_torque[axis];
  return axis < robot.effort.size() ? robot.effort[axis] : 0.0;
}

double Fingers::fraction_in_contact(double touch_time) const noexcept {
  double all = 0.0, touching = 0.0;
  for (const Finger& f : fingers_) {
    all += std::abs(f.effort);
    if (f.pressed_for >= touch_time) touching += std::abs(f.effort);
  }
  return all > 0.0 ? touching / all : 0.0;
}

int Fingers::count_pressing(const RobotState& robot, double effort) const noexcept {
  int count = 0;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const Finger& f = fingers_[i];
    if (f.grip != 0.0 && f.grip * pressed(robot, i) > effort / f.lever) ++count;
  }
  return count;
}

bool Fingers::all_push(const RobotState& robot, double effort, double ratio) const noexcept {
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    const double own = std::abs(fingers_[i].effort);
    if (own <= effort / fingers_[i].lever) continue;
    const double pushed = std::copysign(1.0, fingers_[i].effort) * pressed(robot, i);
    if (pushed < ratio * own) return false;
  }
  return true;
}

void Fingers::hold_object(double min_effort) noexcept {
  for (Finger& f : fingers_) {
    f.held = f.target;
    f.grip = std::abs(f.effort) < min_effort ? 0.0 : std::copysign(1.0, f.effort);
  }
}

}  // namespace handsel::trajectory_controller
