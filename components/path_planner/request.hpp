// From what is asked on the bus to a problem. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/planning.hpp"
#include "components/path_planner/pose_goals.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// Returns why no planner could serve this request, one sentence; empty: the request makes sense.
/// What needs the scene is not checked.
std::string contradiction(const RobotModel& robot, const PathRequest& request);

/// Returns the places of the tip in the frame of the robot's root link.
std::vector<PoseGoal> pose_goals(const PathRequest& request, const Pose& T_world_root);

/// Returns the problem without goals and budget. The request is without contradiction.
Problem problem_of(const RobotModel& robot, const PathRequest& request, const Pose& T_world_root);

/// Returns the reply to a request that was planned for; its outcome is not set.
PathReply reply_of(const RequestId& id, const Result& result);
/// Returns the reply to a request that is not planned for.
PathReply refusal(const RequestId& id, const std::string& reason);

}  // namespace handsel::path_planner
