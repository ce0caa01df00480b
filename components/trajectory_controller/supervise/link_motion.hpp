// SPDX-License-Identifier: Apache-2.0
// Velocities of a robot's links from those of its axes. Pure.
#pragma once

#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::trajectory_controller {

/// Velocity of a link's frame.
struct LinkTwist {
  /// Of the origin of the frame [m/s]; angular [rad/s]; root axes.
  Vector3 linear{Vector3::Zero()}, angular{Vector3::Zero()};
};

/// Of all links for the velocities of all axes, at poses from RobotModel::forward. `out` is resized
/// once, then reused.
void link_twists(const RobotModel& robot, const Vector& velocity,
                 const std::vector<Pose>& T_root_link, std::vector<LinkTwist>& out);

}  // namespace handsel::trajectory_controller
