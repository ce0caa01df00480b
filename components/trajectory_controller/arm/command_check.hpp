// SPDX-License-Identifier: Apache-2.0
// Which commands are accepted: whether any counts now, and whether a trajectory can be run. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/model/robot_model.hpp"
#include "components/trajectory_controller/input/motion_permission.hpp"

namespace handsel::trajectory_controller {

/// What decides whether a command counts now.
struct CommandConditions {
  const RobotModel& robot;             ///< that is controlled
  const MotionPermission& permission;  ///< in force
  bool ready{};                        ///< the robot's configuration is known
  double max_age{};                    ///< of commands at arrival [s]
  Mode mode{Mode::hold};               ///< of the last cycle
  Cause cause{Cause::none};            ///< of that mode
};

/// Head of a command.
struct CommandHead {
  const std::string& robot;  ///< it is for
  std::uint64_t epoch{};     ///< of the Go it belongs to
  double age{};              ///< at arrival [s]
};

/// Returns why no command with this head counts now, one sentence; empty: it counts.
std::string why_not_now(const CommandHead& head, const CommandConditions& now);

/// Returns why a trajectory cannot be run: axes, limits, bounds, end at rest. One sentence; empty:
/// it can. A command without axes is a stop, which can.
std::string why_not_executable(const TrajectoryCommand& command, const RobotModel& robot);

/// How far an axis may be from where a trajectory begins [rad, m].
struct StartReach {
  double at_rest{};    ///< of an axis at rest
  double in_motion{};  ///< of an axis in motion
};

/// Returns why a trajectory cannot begin at rest within `reach` of `set_point` (all axes), one
/// sentence; empty: it can.
std::string why_not_from(const MotionState3& set_point, const TrajectoryCommand& command,
                         const RobotModel& robot, const StartReach& reach);

/// Returns the limits of some axes of the robot, in their order.
KinematicLimits limits_of_axes(const KinematicLimits& limits,
                               const std::vector<std::uint32_t>& axes);

}  // namespace handsel::trajectory_controller
