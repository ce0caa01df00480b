// SPDX-License-Identifier: Apache-2.0
// Driver of an arm at 1 kHz that reacts to contact and to violated limits by a reflex and must then
// be recovered, whose velocity limits shrink toward the ends of its joints, and which carries a
// parallel gripper commanded by width and force (as Franka's arms do). Own method: the maker's
// library, which goes behind ReflexLink, is not part of this code. Pure.
#pragma once

#include "deploy/drivers/driver_core.hpp"

namespace handsel::drivers {

enum class ArmMode : std::uint8_t { idle, moving, reflex, user_stopped, emergency_stopped };

/// What the arm's controller says each cycle; arm axes only.
struct ReflexState {
  std::uint64_t cycle{};                  ///< number of the arm's cycle: a gap shows missed states
  ArmMode mode{ArmMode::idle};            ///< of the arm's controller
  bool powered{true}, brakes_open{true};  ///< motion needs both
  Vector position, velocity, torque, external_torque;  ///< measured [rad, rad/s, Nm, Nm]
  Wrench wrist_wrench;     ///< of the world on hand and load, no gravity of the hand; tool frame
  double gripper_width{};  ///< between the fingers [m]
  double gripper_force{};  ///< with which they press [N]
  std::string error;       ///< why the reflex
};

/// The maker's side. To be filled in for a real arm.
class ReflexLink {
 public:
  virtual ~ReflexLink() = default;
  /// Writes the newest state; false when this cycle's did not come: `out` is not used then.
  virtual bool read(ReflexState& out) = 0;
  virtual void move_to(const Vector& position) = 0;           ///< for this cycle
  virtual void recover() = 0;                                 ///< from a reflex
  virtual void set_load(double mass) = 0;                     ///< [kg]
  virtual void gripper_move(double width, double speed) = 0;  ///< without force [m, m/s]
  virtual void gripper_grasp(double width, double speed, double force) = 0;  ///< [m, m/s, N]
};

/// Parallel gripper on one axis of the robot description.
struct GripperSettings {
  int axis{-1};                                ///< robot axis; -1: none
  double open{}, closed{};                     ///< axis positions of the widths below [rad] or [m]
  double open_width{0.08}, closed_width{0.0};  ///< [m]
  double speed{0.1};                           ///< [m/s]
  double stiffness{400.0};  ///< force for a set-point beyond the measured position [N/m of width]
  double min_force{5.0}, max_force{40.0};  ///< [N]
};

struct ReflexSettings {
  DriverSettings common;    ///< settings that every driver has
  GripperSettings gripper;  ///< axis -1 when the arm has none
  /// Of the velocity limit toward a joint's end: v = sqrt(2 a (end - q)) [rad/s^2].
  double joint_deceleration{3.0};
  double limit_ratio{0.95};  ///< fraction of the maker's velocity limit that set-points may use
  int lost_cycles{20};       ///< so many without a state: the arm's controller is silent
};

/// Returns the largest speed allowed at `position` toward an upper `end` [rad]: the smaller of
/// `max_velocity` and the speed from which `deceleration` stops at `end` [rad/s]; 0 from `end` on.
/// For a lower end both positions are negated.
double velocity_toward_end(double position, double end, double max_velocity, double deceleration);

class ReflexArm : public Driver {
 public:
  static constexpr double kCycle = 0.001;  ///< of the arm's controller [s]

  /// `model` and `link` must outlive this. `arm_axes`: robot axes in the order of ReflexState.
  ReflexArm(const RobotModel& model, std::vector<int> arm_axes, ReflexLink& link,
            const ReflexSettings& settings);

  void cycle(double now) override;
  /// Records a person's acknowledgement; in a reflex it first asks the controller to recover.
  void acknowledge() override;
  RobotState state() const override { return core_.state(commanding_); }
  std::string trouble() const override {
    return state_.position.size() == 0 ? "nothing was received from the arm's controller yet"
                                       : core_.trouble();
  }
  const DriverCore& core() const override { return core_; }

 protected:
  bool follow(const JointCommand& command, double now) override;
  void set_load(double mass) override;

 private:
  void update_mode();
  void drive_gripper();
  double width_of(double position) const;

  ReflexLink& link_;
  ReflexSettings settings_;
  DriverCore core_;
  Measured measured_;
  ReflexState state_, received_;
  CycleCount count_;
  bool commanding_{}, recovering_{};
  int lost_{};
  double commanded_width_{-1.0}, commanded_force_{};
  int gripper_wait_{};
};

}  // namespace handsel::drivers
