// SPDX-License-Identifier: Apache-2.0
// Brings resting set-points to where the robot is, while it does not follow them: to the robot
// side's own reference, or to the measured configuration. Pure, no heap after construction.
#pragma once

#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/axis_groups.hpp"
#include "components/trajectory_controller/hand/hands.hpp"
#include "components/trajectory_controller/input/robot_input.hpp"
#include "components/trajectory_controller/input/robot_reference.hpp"

namespace handsel::trajectory_controller {

/// When set-points are brought to the robot.
struct ReferenceFollowerSettings {
  bool dry_run{};               ///< no robot follows the set-points
  double hand_rejoin{0.25};     ///< fingers, where they are farther off than this [rad]
  double timeout{0.02};         ///< an older robot state says nothing of the reference [s]
  ReferenceSettings reference;  ///< how the reference is compared
};

/// Inputs of one step.
struct ReferenceInputs {
  const RobotInput& robot;      ///< newest state
  const SetPoints& set_points;  ///< sent last
  double age{};                 ///< of the robot state [s]
  bool fault{};                 ///< mode Fault
  std::uint64_t cycle{};        ///< number of the cycle
};

class ReferenceFollower {
 public:
  /// Keeps a reference to the groups.
  ReferenceFollower(const ReferenceFollowerSettings& settings, const AxisGroups& groups);

  /// Sets arm, head and hands at rest in motion to where the robot is, at each comparison of the
  /// reference.
  void step(const ReferenceInputs& in, ArmMotion& arm, AxisMovers& head, Hands& hands) noexcept;
  /// Returns whether the robot side rests elsewhere, so that set-points do not move the robot.
  bool moves_nothing() const noexcept;
  /// Where the servos of the robot side hold.
  const RobotReference& reference() const noexcept { return reference_; }

 private:
  enum class Target : char { none, reference, measured, adopted };

  Target find_target(const RobotState& robot) noexcept;
  void adopt(const RobotState& robot) noexcept;
  bool rests(const RobotState& robot, int axis) const noexcept;
  void follow(Target target, const RobotState& robot, const std::vector<int>& axes,
              AxisMovers& movers) const noexcept;

  ReferenceFollowerSettings settings_;
  const AxisGroups& groups_;
  RobotReference reference_;
  bool apart_{};  // set-points and robot may be at different places: under a fault, or stopped
  // Measured configuration that set-points were taken to since the robot side last followed; the
  // measured one at the last evaluation of the reference. All axes [rad, m].
  Vector adopted_, measured_before_;
  bool has_adopted_{};
};

}  // namespace handsel::trajectory_controller
