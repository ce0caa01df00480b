// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/robot_activity.hpp"

#include <cmath>

namespace handsel::ros2_lane {
namespace {

constexpr double kAtRest = 1e-3;  // max speed of an axis at rest [rad/s]

}  // namespace

void RobotActivity::on(const ActiveTrajectory& active, TimePoint arrival) {
  active_ = active;
  active_at_ = arrival;
}

std::string RobotActivity::why_not_ready(const Group& arm, TimePoint now, double max_age) const {
  if (!active_ || !execution_ || to_seconds(now - active_at_) > max_age)
    return "no message of the trajectory controller arrives";
  if (action_ && action_->state == ActionState::running) return "a task runs; cancel it first";
  for (const int axis : arm.axes)
    if (std::abs(active_->velocity[axis]) > kAtRest) return "the arm is in motion";
  return {};
}

}  // namespace handsel::ros2_lane
