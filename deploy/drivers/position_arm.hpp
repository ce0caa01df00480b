// SPDX-License-Identifier: Apache-2.0
// Driver of a position-controlled arm whose controller sends its state every cycle and must be
// answered within it by a joint position (as in KUKA's fast research interface). Own method: the
// maker's library, which goes behind CyclicLink, is not part of this code. Pure.
#pragma once

#include "deploy/drivers/driver_core.hpp"

namespace handsel::drivers {

/// Ordered: further down means more is possible.
enum class Session : std::uint8_t {
  idle,
  monitoring,
  monitoring_ready,
  commanding_wait,
  commanding_active
};
enum class Safety : std::uint8_t { clear, user_stop, emergency_stop };

/// What the arm's controller sends at the beginning of a cycle; arm axes only.
struct CyclicState {
  std::uint64_t cycle{};            ///< number of the arm's cycle: a gap shows missed states
  Session session{Session::idle};   ///< what commands the controller accepts
  Safety safety{Safety::clear};     ///< stop that is in force; clear: none
  bool drives_on{}, brakes_open{};  ///< motion needs both
  Vector position, velocity, torque, external_torque;  ///< measured [rad, rad/s, Nm]
  /// Position of its own interpolator [rad]: the required answer in commanding_wait.
  Vector interpolated;
};

/// The maker's side. To be filled in for a real arm.
class CyclicLink {
 public:
  virtual ~CyclicLink() = default;
  /// The newest message of the arm's controller; false when this cycle's did not come.
  virtual bool receive(CyclicState& out) = 0;
  /// Sends the position of this cycle, arm axes [rad].
  virtual void answer(const Vector& position) = 0;
  /// Requests commanding_wait; valid in monitoring_ready.
  virtual void request_commanding() = 0;
  virtual void set_load(double mass) = 0;  ///< [kg]
};

class PositionArm : public Driver {
 public:
  /// `cycle` of the arm's controller [s]; `arm_axes`: robot axes in the order of the arm's
  /// controller.
  PositionArm(const RobotModel& model, std::vector<int> arm_axes, double cycle, CyclicLink& link,
              const DriverSettings& settings);

  void cycle(double now) override;
  void acknowledge() override { core_.acknowledge(); }
  RobotState state() const override { return core_.state(session_ == Session::commanding_active); }
  std::string trouble() const override;
  const DriverCore& core() const override { return core_; }
  std::uint64_t missed() const { return missed_; }  ///< cycles without a message

 protected:
  bool follow(const JointCommand& command, double now) override {
    return core_.command(command, now);
  }
  void set_load(double mass) override;

 private:
  double cycle_;
  CyclicLink& link_;
  DriverCore core_;
  Session session_{Session::idle};
  CyclicState last_;
  CycleCount count_;
  Measured measured_;
  std::uint64_t missed_{};
  int missed_in_a_row_{};
};

}  // namespace handsel::drivers
