// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/axis_groups.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/manipulator.hpp"
#include "common/model/platform.hpp"

namespace handsel::trajectory_controller {

AxisGroups::AxisGroups(const RobotModel& robot, const BoundNoise& noise)
    : robot_(robot), noise_(noise), parts_(static_cast<std::size_t>(robot.dof()), Part::arm) {
  const auto mark = [&](const Group* group, Part part) {
    if (group == nullptr) return;
    for (int axis : group->axes) parts_[static_cast<std::size_t>(axis)] = part;
  };
  for (const Manipulator& hand : hands_of(robot)) mark(hand.fingers, Part::hand);
  mark(robot.group("head"), Part::head);
  mark(robot.group(kPlatformGroup), Part::platform);
  for (int axis = 0; axis < robot.dof(); ++axis)
    if (part(axis) == Part::arm) arm_joints_.push_back(axis);
  if (const Group* platform = robot.group(kPlatformGroup)) platform_ = platform->axes;
  arm_ = arm_joints_;
  arm_.insert(arm_.end(), platform_.begin(), platform_.end());
  if (const Group* head = robot.group("head")) head_ = head->axes;
}

double AxisGroups::inside(int axis, double position) const noexcept {
  const Axis& bounds = robot_.axes()[static_cast<std::size_t>(axis)];
  if (!(bounds.lower < bounds.upper)) return position;
  const double within = std::clamp(position, bounds.lower, bounds.upper);
  const double allowed = part(axis) == Part::hand ? noise_.finger : noise_.axis;
  return std::abs(within - position) <= allowed ? within : position;
}

}  // namespace handsel::trajectory_controller
