// Where the head must turn for the camera to look at a point. Pure.
#pragma once

#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::trajectory_controller {

/// Positions of the axes of `head` (inside their bounds) that bring the x axis of the robot's gaze link nearest to pointing at
/// `p_root` (root frame [m]), the other axes as in `q`. Returns the present ones when the robot has no gaze link.
std::vector<double> aim(const RobotModel& robot, const Group& head, const Vector& q, const Vector3& p_root);

}  // namespace handsel::trajectory_controller
