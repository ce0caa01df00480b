// SPDX-License-Identifier: Apache-2.0
// Fakes of two makers' controllers, for rehearsal without an arm. They move as commanded, refuse
// what a real one would refuse, and keep account of what was wrong. Pure: the process beside them
// speaks UDP and plays the script.
#pragma once

#include <string>
#include <vector>

#include "deploy/drivers/maker_udp.hpp"

namespace handsel::drivers {

/// What happens to a fake from outside.
struct FakeEvents {
  bool emergency_stop{}, user_stop{}, brake{}, power_off{};  ///< true: in force; the arm stands
  int foreign{};    ///< so many of the next states are those of another arm, with an axis less
  int drop{};       ///< so many of the next states do not reach the driver
  double push{};    ///< external torque on the first axis [Nm]
  double object{};  ///< width of what is between the fingers [m]
};

struct FakeAccount {
  int commanded{};        ///< cycles in which a reference moved the arm
  int violations{};       ///< references a real arm would not have taken
  int sessions{};         ///< commanding sessions that began; recoveries for an arm with reflexes
  int grasps{}, moves{};  ///< of the gripper
  double load{};          ///< commanded payload [kg]
  double grasp_force{};   ///< of the last grasp [N]
  double fastest{};       ///< of any axis [rad/s]
  std::string last_violation;  ///< quantity and axis, or a phrase; empty: none
};

class FakeArm {
 public:
  virtual ~FakeArm() = default;
  virtual double period() const = 0;  ///< [s]
  /// Simulates one cycle; the driver receives the result through state().
  virtual void cycle() = 0;
  virtual std::string state() const = 0;  ///< encoded
  /// Executes a command of the driver; a late position is ignored.
  virtual void on(const Order& order) = 0;

  const Vector& position() const { return position_; }              ///< of the arm axes [rad]
  double speed() const { return velocity_.cwiseAbs().maxCoeff(); }  ///< of the fastest axis [rad/s]

  /// Returns false for a position that does not answer the state of this cycle.
  bool in_time(const Order& order) const {
    return order.kind != OrderKind::position || order.cycle == cycle_count_;
  }

  FakeEvents events;    ///< set from outside, read in each cycle
  FakeAccount account;  ///< of everything since construction

 protected:
  FakeArm(const RobotModel& model, const std::vector<int>& axes) : model_(model), axes_(axes) {
    position_ = gather(model.rest_configuration(), axes);
    velocity_ = Vector::Zero(position_.size());
  }
  void violate(const std::string& what) {
    ++account.violations;
    account.last_violation = what;
  }
  /// Faster than `limit`(axis index, velocity) allows, or a jump of the velocity: the sentence;
  /// empty: it can be followed.
  template <class Limit>
  std::string why_not(const Vector& wanted, const Limit& limit) const;
  /// To `wanted` within this cycle.
  void follow(const Vector& wanted);
  /// Moves on with the velocity of the cycle before: no command came.
  void coast() { position_ += period() * velocity_; }
  void stand() { velocity_.setZero(); }

  const RobotModel& model_;
  std::vector<int> axes_;
  Vector position_, velocity_;
  std::uint64_t cycle_count_{};
};

/// Position-controlled arm with a session that must be negotiated. In commanding_wait the answer
/// must be its own interpolated position; a step faster than the guard limits plus a tenth, or a
/// jump of the velocity, ends the session with a violation; three cycles without an answer end it
/// without one.
class FakeCyclicArm : public FakeArm, public CyclicLink {
 public:
  FakeCyclicArm(const RobotModel& model, const std::vector<int>& axes, double cycle)
      : FakeArm(model, axes), cycle_(cycle) {}

  double period() const override { return cycle_; }
  void cycle() override;
  std::string state() const override { return encode(now()); }
  void on(const Order& order) override;

  // In one process with the driver.
  bool receive(CyclicState& out) override;
  void answer(const Vector& position) override;
  void request_commanding() override;
  void set_load(double mass) override { account.load = mass; }

 private:
  CyclicState now() const;
  void end(const std::string& why);

  double cycle_;
  Vector wanted_;
  Session session_{Session::monitoring};
  bool answered_{true};
  int unanswered_{}, settled_{}, mirrored_{};
};

/// Arm at 1 kHz with reflexes and a parallel gripper. Faster than allowed at a position, a jump of
/// the velocity, or a push: reflex; twenty cycles without a command while it moves: reflex.
class FakeReflexArm : public FakeArm, public ReflexLink {
 public:
  FakeReflexArm(const RobotModel& model, const std::vector<int>& axes, double deceleration)
      : FakeArm(model, axes), deceleration_(deceleration) {}

  double period() const override { return ReflexArm::kCycle; }
  void cycle() override;
  std::string state() const override { return encode(now()); }
  void on(const Order& order) override;

  bool read(ReflexState& out) override;
  void move_to(const Vector& position) override;
  void recover() override;
  void set_load(double mass) override { account.load = mass; }
  void gripper_move(double width, double speed) override;
  void gripper_grasp(double width, double speed, double force) override;
  double width() const { return width_; }  ///< between the fingers [m]

 private:
  ReflexState now() const;
  void reflex(const std::string& why);
  void move_gripper();

  double deceleration_;
  Vector wanted_;
  bool was_commanded_{}, in_reflex_{};
  int untold_{};
  std::string error_;
  double width_{0.08}, gripper_target_{0.08}, gripper_speed_{0.1}, force_{}, gripping_{};
};

}  // namespace handsel::drivers
