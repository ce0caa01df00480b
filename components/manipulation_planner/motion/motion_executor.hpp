// SPDX-License-Identifier: Apache-2.0
// Plans and executes motions of the arm in use, and of the platform.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"
#include "components/manipulation_planner/clients.hpp"
#include "components/manipulation_planner/motion/motion_spec.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// Returns the axes that a motion moves.
const Group& group_of(const Parts& parts, const MotionSpec& motion);
/// Returns how what is held must be carried by a motion; nullopt: in any way. What is tilted
/// farther already may be carried in any way, too.
std::optional<TiltBound> tilt_bound(const Parts& parts, const MotionSpec& motion);
/// Opens a request for a path. `start`: all axes [rad, m].
PathRequest path_request(Parts& parts, const Vector& start, const MotionSpec& motion);
/// Opens a request of `client` for a trajectory along the waypoints. `start`: all axes [rad, m].
TrajectoryRequest trajectory_request(Parts& parts,
                                     Client<TrajectoryRequest, TrajectoryReply>& client,
                                     const std::vector<Vector>& waypoints, const Vector& start,
                                     const MotionSpec& motion);
/// Makes a command for the axes that the motion moves.
TrajectoryCommand trajectory_command(Parts& parts, const Trajectory& trajectory,
                                     const MotionSpec& motion);

// References must outlive the routines.
/// Asks for a path. `start`: all axes [rad, m].
Routine<PlannedPath> plan_path(Parts& parts, const Vector& start, const MotionSpec& motion);
/// Moves along a path until the motion ends, replanning it meanwhile; goals in `motion` may change.
Routine<Outcome> execute(Parts& parts, const std::vector<Vector>& waypoints, MotionSpec& motion);
/// Plans and executes a motion, again if it fails; near a person the arm retreats first.
Routine<Outcome> move(Parts& parts, const MotionSpec& motion);
/// Retreats straight from a person or an object that is touched or too near, to where a path for
/// `next` begins.
Routine<Outcome> retreat_from(Parts& parts, const std::string& touched, const MotionSpec& next);
/// Returns the directions in the world that lead the hand off a person or an object.
std::vector<Vector3> retreat_directions_from(const Parts& parts, const std::string& touched);

}  // namespace handsel::manipulation_planner
