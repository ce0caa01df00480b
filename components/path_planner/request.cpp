// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/request.hpp"

#include <algorithm>

#include "common/model/platform.hpp"

namespace handsel::path_planner {
namespace {

std::string of_also(const RobotModel& robot, const Group& group, const PathRequest& request) {
  for (std::size_t i = 0; i < request.also.size(); ++i) {
    const std::string axis = "axis " + std::to_string(request.also[i]);
    if (static_cast<int>(request.also[i]) >= robot.dof())
      return axis + " is to move along, the robot has " + std::to_string(robot.dof()) + " axes";
    if (std::count(group.axes.begin(), group.axes.end(), static_cast<int>(request.also[i])) > 0)
      return axis + " is to move along with the group \"" + group.name +
             "\", but is one of its own";
    if (std::count(request.also.begin(), request.also.end(), request.also[i]) > 1)
      return axis + " is to move along twice";
  }
  return {};
}

std::string of_cartesian(const PathRequest& request) {
  if (!request.goals.empty())
    return "goals are given as configurations, but a path in the Cartesian space leads to a pose";
  if (request.straight)
    return "a straight line of the joints is asked for, but in the Cartesian space";
  if (!request.running.empty())
    return "the request continues along a path of the joints, but in the Cartesian space";
  if (request.group != "arm")
    return "the Cartesian space is that of the group \"arm\", not of \"" + request.group + "\"";
  if (request.planner != PlannerKind::automatic)
    return "the Cartesian space has one planner: leave the choice to it";
  if (request.upright) return "what is held is kept upright in the joint space only";
  if (request.poses.size() != 1 || !request.poses[0].slack.isZero() || request.poses[0].turn > 0)
    return "a path in the Cartesian space leads to one pose, without slack or turn";
  return {};
}

}  // namespace

std::string contradiction(const RobotModel& robot, const PathRequest& request) {
  const Group* group = robot.group(request.group);
  if (group == nullptr) return "the robot has no group \"" + request.group + "\"";
  if (request.start.size() != robot.dof())
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot has " +
           std::to_string(robot.dof());
  if (request.goals.empty() && request.poses.empty()) return "no goal was given";
  if (!request.goals.empty() && !request.poses.empty())
    return "goals are given as configurations and as poses: only one kind can be meant";
  for (const Vector& goal : request.goals)
    if (goal.size() != static_cast<Eigen::Index>(group->axes.size()))
      return "a goal has " + std::to_string(goal.size()) + " axes, the group \"" + group->name +
             "\" has " + std::to_string(group->axes.size());
  for (const Vector& node : request.running)
    if (node.size() != static_cast<Eigen::Index>(group->axes.size()))
      return "the path that runs has " + std::to_string(node.size()) + " axes, the group \"" +
             group->name + "\" has " + std::to_string(group->axes.size());
  if (!request.poses.empty() && group->tip < 0)
    return "the group \"" + group->name + "\" has no tip that a pose could be meant for";
  if (!request.poses.empty() && request.group == kPlatformGroup)
    return "the platform has no tip that a pose could be meant for: its goals are x, y, heading";
  if (!request.running.empty() && request.straight)
    return "the request continues along a path, but asks for a straight line";
  if (!request.running.empty() && !request.poses.empty())
    return "the request continues along a path of the joints, but its goal is a pose";
  if (request.upright && robot.tool_link() < 0)
    return "what is held is to stay upright, but the robot has no tool frame";
  if (request.upright && !(request.max_tilt > 0))
    return "what is held is to stay upright, but no angle it may lean over is left";
  if (!(request.time_limit > 0)) return "the time limit is zero";
  if (request.space == PlanSpace::cartesian) {
    if (std::string why = of_cartesian(request); !why.empty()) return why;
  } else if (!request.also.empty()) {
    return "axes are to move along with the arm, which is for the Cartesian space only: name a "
           "group that has them";
  }
  return of_also(robot, *group, request);
}

std::vector<PoseGoal> pose_goals(const PathRequest& request, const Pose& T_world_root) {
  std::vector<PoseGoal> out;
  for (const TipGoal& goal : request.poses)
    out.push_back({T_world_root.inverse() * goal.T_world_tip, goal.slack, goal.turn});
  return out;
}

Problem problem_of(const RobotModel& robot, const PathRequest& request, const Pose& T_world_root) {
  Problem problem;
  problem.axes = robot.group(request.group)->axes;
  problem.start = request.start;
  problem.goals = request.goals;
  problem.planner = request.planner;
  problem.seed = request.seed;
  problem.straight = request.straight;
  if (request.upright)
    problem.upright =
        Upright{request.upright_axis, T_world_root.linear().transpose() * Vector3::UnitZ(),
                request.max_tilt, robot.group(request.group)->tip};
  return problem;
}

PathReply reply_of(const RequestId& id, const Result& result) {
  PathReply reply;
  reply.id = id;
  reply.solved = result.solved;
  reply.reason = result.reason;
  reply.start_touches = result.start_touches;
  reply.goal = static_cast<std::uint32_t>(result.goal);
  reply.path = result.path;
  reply.cost = result.cost;
  reply.work = result.work;
  reply.length = result.length;
  reply.checks = result.checks;
  return reply;
}

PathReply refusal(const RequestId& id, const std::string& reason) {
  PathReply reply;
  reply.id = id;
  reply.reason = reason;
  reply.outcome = PathOutcome::blocked;
  return reply;
}

}  // namespace handsel::path_planner
