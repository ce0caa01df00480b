// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/fakes/fake_arm.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::drivers {

namespace {

constexpr int kUnanswered = 3, kSettle = 20, kMirror = 10, kMaxWithoutCommand = 20;  // cycles
constexpr double kPush = 20.0;                                                       // [Nm]
constexpr double kSlack = 1.1;  // fraction of the guard limits
constexpr double kStep = 60.0;  // max change of velocity per second [rad/s^2]

}  // namespace

template <class Limit>
std::string FakeArm::why_not(const Vector& wanted, const Limit& limit) const {
  const Vector velocity = (wanted - position_) / period();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const std::string& name = model_.axes()[static_cast<std::size_t>(axes_[i])].name;
    if (std::abs(velocity[k]) > limit(i, velocity[k])) return "velocity of " + name;
    if (std::abs(velocity[k] - velocity_[k]) > kStep * period())
      return "jump of the velocity of " + name;
  }
  return {};
}

void FakeArm::follow(const Vector& wanted) {
  velocity_ = (wanted - position_) / period();
  position_ = wanted;
  if (velocity_.isZero(0.0)) return;
  ++account.commanded;
  account.fastest = std::max(account.fastest, speed());
}

void FakeCyclicArm::end(const std::string& why) {
  violate(why);
  session_ = Session::monitoring;
  stand();
}

void FakeCyclicArm::cycle() {
  ++cycle_count_;
  const bool commanded = answered_;
  unanswered_ = commanded || session_ < Session::commanding_wait ? 0 : unanswered_ + 1;
  answered_ = false;
  const bool may =
      !events.emergency_stop && !events.user_stop && !events.brake && !events.power_off;
  if (!may || unanswered_ >= kUnanswered) session_ = Session::monitoring;
  settled_ = may && session_ == Session::monitoring ? settled_ + 1 : 0;
  if (settled_ > kSettle) session_ = Session::monitoring_ready;
  if (session_ == Session::commanding_wait) {
    if (commanded && (wanted_ - position_).cwiseAbs().maxCoeff() > 1e-9)
      return end("no mirror of the interpolated position");
    mirrored_ += commanded ? 1 : 0;
    if (mirrored_ > kMirror) {
      session_ = Session::commanding_active;
      ++account.sessions;
    }
  }
  if (session_ != Session::commanding_active) return stand();
  if (!commanded) return coast();
  const std::string why = why_not(wanted_, [&](std::size_t i, double) {
    return kSlack * model_.guard_limits().velocity[axes_[i]];
  });
  if (!why.empty()) return end(why);
  follow(wanted_);
}

void FakeCyclicArm::answer(const Vector& position) {
  if (position.size() != position_.size()) return end("an answer of another number of axes");
  answered_ = true;
  wanted_ = position;
}

void FakeCyclicArm::request_commanding() {
  if (session_ != Session::monitoring_ready) return;
  session_ = Session::commanding_wait;
  mirrored_ = 0;
  wanted_ = position_;
}

void FakeCyclicArm::on(const Order& order) {
  if (!in_time(order)) return;
  if (order.kind == OrderKind::position) answer(order.values);
  if (order.kind == OrderKind::request_commanding) request_commanding();
  if (order.kind == OrderKind::load) set_load(order.values[0]);
}

namespace {

/// Makes values look like those of another arm: one axis less, different positions.
void make_foreign(Vector& values) {
  values.conservativeResize(values.size() - 1);
  values.array() += 1.0;
}

}  // namespace

bool FakeCyclicArm::receive(CyclicState& out) {
  if (events.drop > 0) {
    --events.drop;
    return false;
  }
  out = now();
  if (events.foreign > 0) {
    --events.foreign;
    for (Vector* v :
         {&out.position, &out.velocity, &out.torque, &out.external_torque, &out.interpolated})
      make_foreign(*v);
  }
  return true;
}

CyclicState FakeCyclicArm::now() const {
  CyclicState s;
  s.cycle = cycle_count_;
  s.session = session_;
  s.safety = events.emergency_stop ? Safety::emergency_stop
             : events.user_stop    ? Safety::user_stop
                                   : Safety::clear;
  s.drives_on = !events.power_off;
  s.brakes_open = !events.brake;
  s.position = s.interpolated = position_;
  s.velocity = velocity_;
  s.torque = s.external_torque = Vector::Zero(position_.size());
  s.external_torque[0] = events.push;
  return s;
}

void FakeReflexArm::reflex(const std::string& why) {
  error_ = why;
  in_reflex_ = true;
  was_commanded_ = false;
  stand();
}

void FakeReflexArm::cycle() {
  ++cycle_count_;
  move_gripper();
  if (events.emergency_stop || events.user_stop || events.brake || events.power_off) {
    was_commanded_ = false;
    stand();
    return;
  }
  if (in_reflex_) return;
  if (std::abs(events.push) > kPush)
    return reflex("push on " + model_.axes()[static_cast<std::size_t>(axes_[0])].name);
  if (!was_commanded_) {
    untold_ = speed() > 0.0 ? untold_ + 1 : 0;
    if (untold_ >= kMaxWithoutCommand)
      return reflex("no command for " + std::to_string(kMaxWithoutCommand) + " cycles");
    return coast();
  }
  untold_ = 0;
  was_commanded_ = false;
  const std::string why = why_not(wanted_, [&](std::size_t i, double v) {
    const auto k = static_cast<Eigen::Index>(i);
    const Axis& axis = model_.axes()[static_cast<std::size_t>(axes_[i])];
    const double limit = kSlack * model_.guard_limits().velocity[axes_[i]];
    return v > 0 ? velocity_toward_end(position_[k], axis.upper, limit, deceleration_)
                 : velocity_toward_end(-position_[k], -axis.lower, limit, deceleration_);
  });
  if (!why.empty()) {
    violate(why);
    return reflex(why);
  }
  follow(wanted_);
}

void FakeReflexArm::move_gripper() {
  const double step = gripper_speed_ * period(),
               min_width = std::max(gripper_target_, events.object);
  width_ = width_ > min_width ? std::max(min_width, width_ - step)
                              : std::min(std::max(gripper_target_, width_), width_ + step);
  gripping_ =
      events.object > 0.0 && width_ <= events.object + 1e-9 && gripper_target_ < events.object
          ? force_
          : 0.0;
}

void FakeReflexArm::move_to(const Vector& position) {
  if (position.size() != position_.size()) return violate("a command of another number of axes");
  wanted_ = position;
  was_commanded_ = true;
}

void FakeReflexArm::recover() {
  if (std::abs(events.push) > kPush || !in_reflex_) return;
  in_reflex_ = was_commanded_ = false;
  ++account.sessions;
  stand();
}

void FakeReflexArm::gripper_move(double width, double speed) {
  ++account.moves;
  gripper_target_ = width;
  gripper_speed_ = speed;
  force_ = 0.0;
}

void FakeReflexArm::gripper_grasp(double width, double speed, double force) {
  ++account.grasps;
  gripper_target_ = width;
  gripper_speed_ = speed;
  force_ = account.grasp_force = force;
}

void FakeReflexArm::on(const Order& order) {
  if (!in_time(order)) return;
  const Vector& v = order.values;
  if (order.kind == OrderKind::position) move_to(v);
  if (order.kind == OrderKind::recover) recover();
  if (order.kind == OrderKind::load) set_load(v[0]);
  if (order.kind == OrderKind::gripper_move) gripper_move(v[0], v[1]);
  if (order.kind == OrderKind::gripper_grasp) gripper_grasp(v[0], v[1], v[2]);
}

bool FakeReflexArm::read(ReflexState& out) {
  if (events.drop > 0) {
    --events.drop;
    return false;
  }
  out = now();
  if (events.foreign > 0) {
    --events.foreign;
    for (Vector* v : {&out.position, &out.velocity, &out.torque, &out.external_torque})
      make_foreign(*v);
  }
  return true;
}

ReflexState FakeReflexArm::now() const {
  ReflexState s;
  s.cycle = cycle_count_;
  s.mode = events.emergency_stop ? ArmMode::emergency_stopped
           : events.user_stop    ? ArmMode::user_stopped
           : in_reflex_          ? ArmMode::reflex
           : speed() > 0.0       ? ArmMode::moving
                                 : ArmMode::idle;
  s.powered = !events.power_off;
  s.brakes_open = !events.brake;
  s.position = position_;
  s.velocity = velocity_;
  s.torque = s.external_torque = Vector::Zero(position_.size());
  s.external_torque[0] = events.push;
  s.gripper_width = width_;
  s.gripper_force = gripping_;
  s.error = error_;
  return s;
}

}  // namespace handsel::drivers
