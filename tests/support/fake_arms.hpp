// Scripted fakes of two makers' controllers. They move as they are told, refuse what a real one would, and write down what was wrong.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "deploy/drivers/position_arm.hpp"
#include "deploy/drivers/reflex_arm.hpp"

namespace handsel::test {

/// What both fakes are told by a story.
struct ArmScript {
  bool emergency{}, user_stop{}, brakes_closed{};
};

/// Position-controlled arm with a session that must be negotiated. In commanding_wait the answer must be its own interpolated position; a
/// step faster than `most` ends the session; so do three cycles without an answer.
class FakeCyclicArm : public drivers::CyclicLink {
 public:
  FakeCyclicArm(const Vector& start, double cycle, double most) : cycle_(cycle), most_(most), position_(start), velocity_(0 * start) {}

  ArmScript script;
  int lose{};        ///< so many of the next messages do not come
  double load{};     ///< [kg] as told
  int violations{};  ///< answers that broke the rules
  int commanded{};   ///< answers followed while commanding
  std::string last_violation;

  /// One cycle of the arm's own; the driver is called after it.
  void cycle() {
    if (answered_)
      unanswered_ = 0;
    else if (session_ >= drivers::Session::commanding_wait && ++unanswered_ >= 3)
      session_ = drivers::Session::monitoring;
    answered_ = false;
    const bool may = !script.emergency && !script.user_stop && !script.brakes_closed;
    if (!may) session_ = drivers::Session::monitoring;
    if (may && session_ == drivers::Session::monitoring && ++settled_ > 20) session_ = drivers::Session::monitoring_ready;
    if (session_ != drivers::Session::monitoring) settled_ = 0;
    if (session_ == drivers::Session::commanding_wait && mirrored_ > 10) session_ = drivers::Session::commanding_active;
    const bool follow = session_ == drivers::Session::commanding_active;
    velocity_ = follow ? Vector((wanted_ - position_) / cycle_) : Vector(0 * position_);
    if (follow) position_ = wanted_;
  }
  bool receive(drivers::CyclicState& out) override {
    if (lose > 0) {
      --lose;
      return false;
    }
    out.session = session_;
    out.safety = script.emergency   ? drivers::Safety::emergency_stop
                 : script.user_stop ? drivers::Safety::user_stop
                                    : drivers::Safety::clear;
    out.drives_on = true;
    out.brakes_open = !script.brakes_closed;
    out.position = out.interpolated = position_;
    out.velocity = velocity_;
    out.torque = out.external_torque = 0 * position_;
    return true;
  }
  void answer(const Vector& position) override {
    answered_ = true;
    if (session_ == drivers::Session::commanding_wait) {
      if ((position - position_).cwiseAbs().maxCoeff() > 1e-9) return violate("no mirror of the interpolated position");
      ++mirrored_;
      wanted_ = position;
      return;
    }
    if (session_ != drivers::Session::commanding_active) return violate("an answer outside of commanding");
    if ((position - position_).cwiseAbs().maxCoeff() > most_ * cycle_) return violate("too fast");
    wanted_ = position;
    ++commanded;
  }
  void request_commanding() override {
    if (session_ != drivers::Session::monitoring_ready) return violate("commanding asked for too early");
    session_ = drivers::Session::commanding_wait;
    mirrored_ = 0;
    wanted_ = position_;
  }
  void set_load(double mass) override { load = mass; }
  const Vector& position() const { return position_; }

 private:
  void violate(const std::string& what) {
    ++violations;
    last_violation = what;
    session_ = drivers::Session::monitoring;
  }
  double cycle_, most_;
  Vector position_, velocity_, wanted_;
  drivers::Session session_{drivers::Session::monitoring};
  bool answered_{true};
  int unanswered_{}, settled_{}, mirrored_{};
};

/// Arm at 1 kHz with reflexes and a parallel gripper. Faster than allowed at a position, a jump of the velocity, or a push: reflex.
class FakeReflexArm : public drivers::ReflexLink {
 public:
  FakeReflexArm(const RobotModel& model, const std::vector<int>& axes, const Vector& start, double deceleration)
      : model_(model), axes_(axes), deceleration_(deceleration), position_(start), velocity_(0 * start) {}

  ArmScript script;
  double push{};     ///< external torque on the first axis [Nm]; beyond 20: reflex
  double object{};   ///< width of what is between the fingers [m]
  double load{};     ///< [kg] as told
  int violations{};  ///< reflexes that commands caused
  int commanded{}, recoveries{}, moves{}, grasps{};
  double force{};  ///< of the last grasp command [N]
  std::string error;

  void cycle() {
    constexpr double kCycle = 0.001;
    if (script.emergency || script.user_stop || script.brakes_closed) {
      velocity_.setZero();
      told_ = false;
      if (mode_ != drivers::ArmMode::reflex) mode_ = drivers::ArmMode::idle;
    } else if (std::abs(push) > 20.0 && mode_ != drivers::ArmMode::reflex) {
      reflex("push");
    } else if (told_ && mode_ != drivers::ArmMode::reflex) {
      const Vector velocity = (wanted_ - position_) / kCycle;
      for (std::size_t i = 0; i < axes_.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        const Axis& axis = model_.axes()[static_cast<std::size_t>(axes_[i])];
        const double most = model_.guard_limits().velocity[axes_[i]], v = velocity[k];
        const double end = v > 0 ? drivers::velocity_toward_end(position_[k], axis.upper, most, deceleration_)
                                 : drivers::velocity_toward_end(-position_[k], -axis.lower, most, deceleration_);
        if (std::abs(v) > end + 1e-3) return command_broke("velocity of " + axis.name);
        if (std::abs(v - velocity_[k]) > 0.05) return command_broke("velocity jump of " + axis.name);
      }
      if (velocity.cwiseAbs().maxCoeff() > 0) ++commanded;
      position_ = wanted_;
      velocity_ = velocity;
      mode_ = velocity.isZero(0.0) ? drivers::ArmMode::idle : drivers::ArmMode::moving;
    }
    const double step = gripper_speed_ * kCycle, least = std::max(gripper_target_, object);
    width_ = width_ > least ? std::max(least, width_ - step) : std::min(std::max(gripper_target_, width_), width_ + step);
    gripping_ = object > 0.0 && width_ <= object + 1e-9 && gripper_target_ < object ? force : 0.0;
  }
  void read(drivers::ReflexState& out) override {
    out.mode = script.emergency ? drivers::ArmMode::emergency_stopped : script.user_stop ? drivers::ArmMode::user_stopped : mode_;
    out.powered = true;
    out.brakes_open = !script.brakes_closed;
    out.position = position_;
    out.velocity = velocity_;
    out.torque = out.external_torque = 0 * position_;
    out.external_torque[0] = push;
    out.gripper_width = width_;
    out.gripper_force = gripping_;
    out.error = error;
  }
  void move_to(const Vector& position) override {
    wanted_ = position;
    told_ = true;
  }
  void recover() override {
    if (std::abs(push) > 20.0) return;
    ++recoveries;
    told_ = false;
    velocity_.setZero();
    mode_ = drivers::ArmMode::idle;
  }
  void set_load(double mass) override { load = mass; }
  void gripper_move(double width, double speed) override {
    ++moves;
    gripper_target_ = width;
    gripper_speed_ = speed;
    force = 0.0;
  }
  void gripper_grasp(double width, double speed, double with) override {
    ++grasps;
    gripper_target_ = width;
    gripper_speed_ = speed;
    force = with;
  }
  const Vector& position() const { return position_; }
  double width() const { return width_; }

 private:
  void reflex(const std::string& why) {
    error = why;
    mode_ = drivers::ArmMode::reflex;
    velocity_.setZero();
    told_ = false;
  }
  void command_broke(const std::string& why) {
    ++violations;
    reflex(why);
  }
  const RobotModel& model_;
  std::vector<int> axes_;
  double deceleration_;
  Vector position_, velocity_, wanted_;
  drivers::ArmMode mode_{drivers::ArmMode::idle};
  bool told_{};
  double width_{0.08}, gripper_target_{0.08}, gripper_speed_{0.1}, gripping_{};
};

}  // namespace handsel::test
