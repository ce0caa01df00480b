// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/command_check.hpp"

#include <cmath>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "components/trajectory_controller/output/setpoint_check.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kAtRest = 1e-6;

/// Returns why the trajectory does not fit the axes that the command names.
std::string why_not_axes(const TrajectoryCommand& command, const RobotModel& robot) {
  if (command.trajectory.size() != static_cast<int>(command.axes.size()))
    return "it has " + std::to_string(command.trajectory.size()) + " axes and names " +
           std::to_string(command.axes.size());
  const auto count = static_cast<std::size_t>(robot.dof());
  std::vector<char> used(count, 0);
  for (std::uint32_t axis : command.axes) {
    if (axis >= count) return "axis " + std::to_string(axis) + " does not exist";
    const std::string& name = robot.axes()[axis].name;
    if (used[axis]++) return "axis " + name + " comes twice";
  }
  return {};
}

}  // namespace

KinematicLimits limits_of_axes(const KinematicLimits& limits,
                               const std::vector<std::uint32_t>& axes) {
  KinematicLimits part;
  const auto n = static_cast<Eigen::Index>(axes.size());
  part.velocity.resize(n);
  part.acceleration.resize(n);
  part.jerk.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto axis = axes[static_cast<std::size_t>(i)];
    part.velocity[i] = limits.velocity[axis];
    part.acceleration[i] = limits.acceleration[axis];
    part.jerk[i] = limits.jerk[axis];
  }
  return part;
}

std::string why_not_now(const CommandHead& head, const CommandConditions& now) {
  const std::string& name = now.robot.name();
  if (head.robot != name) return "it is for robot " + head.robot + ", this is " + name;
  if (!now.ready) return "the robot's configuration is not known yet";
  if (head.age > now.max_age) return "it is " + std::to_string(head.age) + " s old";
  const std::uint64_t epoch = now.permission.go().epoch;
  if (!now.permission.received() || head.epoch != epoch)
    return "its epoch " + std::to_string(head.epoch) + " is not the one in force, " +
           std::to_string(epoch);
  if (now.mode >= Mode::stop)
    return std::string("the controller is in mode ") + handsel::name(now.mode) + ": " +
           handsel::name(now.cause);
  return {};
}

std::string why_not_executable(const TrajectoryCommand& command, const RobotModel& robot) {
  if (command.axes.empty() && command.trajectory.size() == 0) return {};
  if (!std::isfinite(command.switch_at)) return "its switch_at is not a number";
  std::string reason = why_not_axes(command, robot);
  if (!reason.empty()) return reason;
  const KinematicLimits limits = limits_of_axes(robot.guard_limits(), command.axes);
  reason = why_not_within(command.trajectory, limits, kLimitTolerance);
  if (!reason.empty()) return reason;
  const MotionState3 last = final_state(command.trajectory);
  for (std::size_t i = 0; i < command.axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Axis& axis = robot.axes()[command.axes[i]];
    if (std::abs(last.velocity[k]) > kAtRest || std::abs(last.acceleration[k]) > kAtRest)
      return "axis " + axis.name + " does not end at rest";
    const AxisExtremes reach = extremes(command.trajectory.axes[i]);
    if (reach.lowest < axis.lower - kAtRest || reach.highest > axis.upper + kAtRest)
      return "axis " + axis.name + " would reach [" + std::to_string(reach.lowest) + ", " +
             std::to_string(reach.highest) + "] rad, outside its bounds";
  }
  return {};
}

std::string why_not_from(const MotionState3& set_point, const TrajectoryCommand& command,
                         const RobotModel& robot, const StartReach& reach) {
  const MotionState3 first = command.trajectory.at(0.0);
  for (std::size_t i = 0; i < command.axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Axis& axis = robot.axes()[command.axes[i]];
    if (std::abs(first.velocity[k]) > kAtRest || std::abs(first.acceleration[k]) > kAtRest)
      return "axis " + axis.name + " does not start at rest";
    const std::uint32_t number = command.axes[i];
    const bool rests = set_point.velocity[number] == 0.0 && set_point.acceleration[number] == 0.0;
    const double off = std::abs(first.position[k] - set_point.position[number]);
    if (!(off <= (rests ? reach.at_rest : reach.in_motion)))
      return "axis " + axis.name + " starts " + std::to_string(off) + " rad from the set-point";
  }
  return {};
}

}  // namespace handsel::trajectory_controller
