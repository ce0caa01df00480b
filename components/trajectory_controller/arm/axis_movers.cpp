// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/axis_movers.hpp"

#include <utility>

namespace handsel::trajectory_controller {

AxisMovers::AxisMovers(const RobotModel& robot, std::vector<int> axes)
    : robot_(robot),
      axes_(std::move(axes)),
      own_(axes_.size()),
      moved_(static_cast<std::size_t>(robot.dof()), 0),
      movers_(moved_.size()) {
  for (const int axis : axes_) moved_[static_cast<std::size_t>(axis)] = 1;
}

void AxisMovers::set_further_axes(const std::vector<std::uint32_t>& axes) {
  drop_further_axes();
  for (const std::uint32_t axis : axes) {
    if (moved_[axis] != 0) continue;
    axes_.push_back(static_cast<int>(axis));
    moved_[axis] = 1;
  }
}

void AxisMovers::drop_further_axes() noexcept {
  for (; axes_.size() > own_; axes_.pop_back()) moved_[static_cast<std::size_t>(axes_.back())] = 0;
}

void AxisMovers::reset(const Vector& position) noexcept {
  for (int axis : axes_) reset(axis, position[axis]);
}

void AxisMovers::stop_from(const MotionState3& from) noexcept {
  for (int axis : axes_) {
    const AxisState state{from.position[axis], from.velocity[axis], from.acceleration[axis]};
    at(axis).take_over(state, limits_of(robot_.stop_limits(), axis));
  }
}

void AxisMovers::stop(int axis) noexcept { at(axis).stop(limits_of(robot_.stop_limits(), axis)); }

void AxisMovers::go_to(int axis, double target) noexcept {
  go_to(axis, target, limits_of(robot_.comfort_limits(), axis));
}

void AxisMovers::go_to(int axis, double target, const AxisLimits& limits) noexcept {
  at(axis).go_to(target, limits, limits_of(robot_.stop_limits(), axis));
}

bool AxisMovers::step(int axis, double dt, MotionState3& set_point) noexcept {
  const AxisState& state = at(axis).step(dt);
  set_point.position[axis] = state.position;
  set_point.velocity[axis] = state.velocity;
  set_point.acceleration[axis] = state.acceleration;
  return at(axis).at_rest();
}

void AxisMovers::step(double dt, MotionState3& set_point) noexcept {
  for (int axis : axes_) step(axis, dt, set_point);
}

}  // namespace handsel::trajectory_controller
