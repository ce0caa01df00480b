// SPDX-License-Identifier: Apache-2.0
// What a JointTrajectory asks for, as requests of the system. Pure.
#pragma once

#include <string>

#include "common/config/settings/ros2_lane.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/ros2.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::ros2_lane {

/// One motion of the arm; the ids of its requests are not set.
struct MotionRequest {
  StateQuery query;           ///< Configurations along the path, to be checked for collision.
  TrajectoryRequest request;  ///< Path from the present configuration, to be timed.
  double min_duration{0};     ///< Duration that the JointTrajectory asks for at least [s].
};

/// Fills `out` with the motion of the robot's arm from `active` along the points of `wanted`.
/// Returns an empty text, or why the motion cannot be done; `out` is then not complete.
std::string make_motion_request(const ros2::JointTrajectory& wanted, const RobotModel& robot,
                                const ActiveTrajectory& active,
                                const settings::Ros2LaneSettings& settings, MotionRequest& out);

}  // namespace handsel::ros2_lane
