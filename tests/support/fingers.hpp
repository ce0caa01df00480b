// SPDX-License-Identifier: Apache-2.0
// The controller's hand executor for the hand of a robot.
#pragma once

#include <memory>
#include <utility>

#include "common/model/robot_model.hpp"
#include "components/trajectory_controller/hand/hand_executor.hpp"

namespace handsel::test {

/// Returns an executor at rest in the configuration `posture`, all axes [rad].
inline std::unique_ptr<trajectory_controller::HandExecutor> fingers_of(const RobotModel& robot,
                                                                       const Group& hand,
                                                                       const Vector& posture) {
  trajectory_controller::HandAxes axes{hand.axes, {}, {}, {}};
  for (const int axis : hand.axes) {
    axes.lower.push_back(robot.axes()[static_cast<std::size_t>(axis)].lower);
    axes.upper.push_back(robot.axes()[static_cast<std::size_t>(axis)].upper);
  }
  auto fingers = std::make_unique<trajectory_controller::HandExecutor>(
      trajectory_controller::HandSettings{}, std::move(axes), robot.comfort_limits(),
      robot.stop_limits());
  fingers->reset(posture);
  return fingers;
}

}  // namespace handsel::test
