// SPDX-License-Identifier: Apache-2.0
// The arm at rest: complies with pushes, and retreats from people who come too near. Pure, no heap
// after construction.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/input/contact_watch.hpp"
#include "components/trajectory_controller/input/inputs.hpp"
#include "components/trajectory_controller/supervise/guard.hpp"
#include "components/trajectory_controller/supervise/link_motion.hpp"
#include "components/trajectory_controller/supervise/mode_machine.hpp"

namespace handsel::trajectory_controller {

/// How the arm complies and retreats.
struct ComplianceSettings {
  double speed{0.2};               ///< largest speed of an axis while complying [rad/s]; 0: never
  double reach{0.3};               ///< largest travel of each axis while complying [rad]
  double retreat_speed{1.0};       ///< largest speed of an axis in a retreat [rad/s]
  double retreat_reach{0.3};       ///< largest travel of each axis in a retreat; 0: never [rad]
  double torque{15.0};             ///< an axis pushed by more than this complies [Nm]
  double lead{0.5};                ///< of motion that the target of an axis lies ahead [s]
  double retreat_range{1.2};       ///< links farther from the person do not count in a retreat [m]
  double retreat_damping{0.02};    ///< of the axes in the direction of a retreat [m^2]
  double retreat_min_factor{0.1};  ///< of the speed of a retreat that must be allowed
  std::uint32_t aim_cycles{10};    ///< between two choices of the motion of a retreat
};

/// Inputs of one step.
struct ComplianceInputs {
  const Inputs& inputs;         ///< newest samples
  const ContactWatch& contact;  ///< of the arm
  const SetPoints& set_points;  ///< sent last
  const ModeVerdict& verdict;   ///< of this cycle
  const GuardVerdict& nearest;  ///< of where the arm is
  double retreat_factor{};      ///< of the speed of a retreat that is allowed, [0, 1]
  bool may_comply{};            ///< the arm is at rest and may comply with pushes
  bool may_retreat{};           ///< the arm is off its path, and attention asks for a recoil
  std::uint64_t cycle{};        ///< number of the cycle
};

class Compliance {
 public:
  /// Keeps references to the robot and the arm. `joints`: number of axes of the arm that comply,
  /// the first ones; a platform does not.
  Compliance(const ComplianceSettings& settings, const RobotModel& robot, std::size_t joints,
             ArmMotion& arm);

  /// Moves the axes of an arm at rest.
  void step(const ComplianceInputs& in) noexcept;
  /// Returns whether the arm moves, or is still to come to rest, because of a push or a retreat.
  bool moving() const noexcept { return moving_; }
  /// Returns whether it does so because of a push.
  bool complying() const noexcept { return moving_ && wish_ != Wish::retreat; }
  /// Velocity of a retreat that is wished for, all axes [rad/s]; nullptr: none is.
  const Vector* retreat() const noexcept {
    return wish_ == Wish::retreat ? &retreat_velocity_ : nullptr;
  }

 private:
  enum class Wish : char { none, comply, retreat };

  Wish find_wish(const ComplianceInputs& in) noexcept;
  bool waits_for_rest(const ComplianceInputs& in) noexcept;
  void aim_away(const ComplianceInputs& in) noexcept;
  void move(int axis, double speed, double reach) noexcept;

  ComplianceSettings settings_;
  const RobotModel& robot_;
  std::size_t joints_;
  ArmMotion& arm_;
  Wish wish_{Wish::none};
  bool moving_{};
  bool waits_for_rest_{};
  std::uint32_t demands_{};                // for rest, of the last cycle
  Vector from_;                            // where the motion began, all axes
  Vector retreat_velocity_;                // [rad/s]
  Vector one_axis_;                        // scratch of aim_away(), as what follows
  std::vector<Eigen::Matrix3Xd> effects_;  // of each axis on the origin of each link [m]
  Eigen::MatrixXd hessian_;
  Vector gradient_;
  Eigen::LDLT<Eigen::MatrixXd> solver_;
  std::vector<Pose> links_;
  std::vector<LinkTwist> twists_;
};

}  // namespace handsel::trajectory_controller
