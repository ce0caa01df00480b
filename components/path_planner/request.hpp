// SPDX-License-Identifier: Apache-2.0
// Converts requests on the bus to problems, and results to replies. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/planning.hpp"
#include "components/path_planner/pose_goals.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// Returns why the request is invalid, one sentence; empty: valid. Does not check what depends on
/// the scene.
std::string contradiction(const RobotModel& robot, const PathRequest& request);

/// Returns the goal poses of the tip in the frame of the robot's root link.
std::vector<PoseGoal> pose_goals(const PathRequest& request, const Pose& T_world_root);

/// Returns the problem without goals and budget, for a valid request.
Problem problem_of(const RobotModel& robot, const PathRequest& request, const Pose& T_world_root);

/// Returns the reply to a planned request; does not set the outcome.
PathReply reply_of(const RequestId& id, const Result& result);
/// Returns the reply to a refused request.
PathReply refusal(const RequestId& id, const std::string& reason);

}  // namespace handsel::path_planner
