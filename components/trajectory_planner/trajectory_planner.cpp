// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/trajectory_planner.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "components/trajectory_planner/motion_check.hpp"

namespace handsel::trajectory_planner {
namespace {

std::string why_bad(const RobotModel& robot, const TrajectoryRequest& request) {
  if (!(request.speed_scale > 0 && request.speed_scale <= 1))
    return "speed_scale must be in (0, 1]";
  const Group* group = robot.group(request.group);
  if (group == nullptr) return "the robot has no group \"" + request.group + "\"";
  if (request.start.size() != robot.dof()) {
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot " +
           std::to_string(robot.dof());
  }
  if (!request.start.allFinite()) return "the start has a number that is not finite";
  if (!request.follower.empty()) {
    const Group* follower = robot.group(request.follower);
    if (follower == nullptr || follower->tip < 0)
      return "the robot has no arm \"" + request.follower + "\" that could follow";
    if (request.poses.empty())
      return "an arm can only follow a motion of the tool, the request is one of joints";
  }
  if (!request.poses.empty())
    return group->tip < 0 ? "the group \"" + request.group + "\" has no tip" : std::string{};
  if (request.nodes.empty()) return "there are no nodes";
  for (const Vector& node : request.nodes) {
    if (node.size() != static_cast<Eigen::Index>(group->axes.size())) {
      return "a node has " + std::to_string(node.size()) + " axes, the group \"" + request.group +
             "\" " + std::to_string(group->axes.size());
    }
  }
  return {};
}

KinematicLimits comfort_limits(const RobotModel& robot, const Group& group, double speed_factor) {
  const KinematicLimits& all = robot.comfort_limits();
  return {RobotModel::part(all.velocity, group) * speed_factor,
          RobotModel::part(all.acceleration, group), RobotModel::part(all.jerk, group)};
}

/// Checks blends: position limits at the exact extremes, collisions along the blend.
class CornerJudge {
 public:
  CornerJudge(const RobotModel& robot, const Group& group, CollisionWorld& world,
              const HumanCost& cost, const Vector& start, double step)
      : robot_(robot),
        group_(group),
        cost_(cost),
        start_(start),
        step_(step),
        bound_(cost.forbids() && cost.forbidden(start).layer == nullptr),
        motion_(robot, world, group.axes, start) {}

  bool operator()(const Trajectory& corner) {
    double rate = 0;
    for (int i = 0; i < corner.size(); ++i) {
      const AxisExtremes e = extremes(corner.axes[i]);
      const Axis& axis = robot_.axes()[group_.axes[i]];
      const bool continuous = robot_.joints()[axis.joint].kind == JointKind::continuous;
      if (!continuous && (e.lowest < axis.lower || e.highest > axis.upper)) return false;
      rate = std::max(rate, e.velocity);
    }
    const SegmentTable table(corner);
    if (!motion_.free(corner, table)) return false;
    if (!bound_) return true;
    const int parts = std::max(2, static_cast<int>(std::ceil(rate * table.duration() / step_)));
    MotionState3 state = corner.at(0);
    int cursor = 0;
    for (int k = 0; k <= parts; ++k) {
      table.evaluate(table.duration() * k / parts, cursor, state);
      if (cost_.forbidden(RobotModel::with(start_, group_, state.position)).layer != nullptr)
        return false;
    }
    return true;
  }

 private:
  const RobotModel& robot_;
  const Group& group_;
  const HumanCost& cost_;
  const Vector& start_;
  double step_;
  bool bound_;  // whether forbidding layers apply; false if the start is forbidden
  MotionCheck motion_;
};

/// Writes the speed zones of the path segments, and max cost, because of people.
void compute_zones(const SpeedAlong& people, const TrajectoryRequest& request, const Group& group,
                   Result& result) {
  if (people.unconcerned()) return;
  for (std::size_t k = 0; k + 1 < request.nodes.size(); ++k) {
    const auto samples = people.along(RobotModel::with(request.start, group, request.nodes[k]),
                                      RobotModel::with(request.start, group, request.nodes[k + 1]));
    for (const SpeedAlong::SpeedSample& look : samples)
      result.cost = std::max(result.cost, std::clamp(look.cost, 0.0, 1.0));
    result.speeds.push_back(SpeedAlong::zones(samples));
  }
}

void tell_speeds(const TrajectoryRequest& request, Result& result) {
  result.speed_factor = request.speed_scale;
  if (result.speeds.empty()) return;
  Vector& speeds = result.reply.speeds;
  speeds = Vector::Ones(static_cast<Eigen::Index>(result.speeds.size()));
  for (std::size_t k = 0; k < result.speeds.size(); ++k)
    for (const LimitZone& zone : result.speeds[k])
      speeds[static_cast<Eigen::Index>(k)] =
          std::min(speeds[static_cast<Eigen::Index>(k)], zone.scale.velocity);
  result.speed_factor *= speeds.minCoeff();
}

void report_stops(const std::vector<BlendReport>& corners, TrajectoryReply& reply) {
  for (const BlendReport& corner : corners)
    if (corner.method == BlendMethod::stop)
      reply.corners.push_back({"corner " + std::to_string(corner.node), corner.reason});
}

/// One request with the models for planning.
struct PlanningCase {
  const RobotModel& robot;
  const Group& group;
  CollisionWorld& world;
  const TrajectoryRequest& request;
  const Settings& settings;
};

void plan_joints(const PlanningCase& given, const HumanCost& cost, const SpeedAlong& people,
                 Result& result) {
  const auto& [robot, group, world, request, settings] = given;
  compute_zones(people, request, group, result);
  tell_speeds(request, result);
  CornerJudge check(robot, group, world, cost, request.start, settings.blend_step);
  SmoothSettings smoothing;
  smoothing.allowed_excess = settings.tool.allowed_excess;
  SmoothResult smoothed = smooth(
      request.nodes, comfort_limits(robot, group, request.speed_scale), smoothing,
      [&check](const Trajectory& corner) { return check(corner); }, result.speeds);
  TrajectoryReply& reply = result.reply;
  if (!(reply.reason = smoothed.reason).empty()) return;
  report_stops(smoothed.corners, reply);
  reply.solved = true;
  reply.reached = static_cast<std::uint32_t>(request.nodes.size());
  reply.duration_ptp = smoothed.duration_ptp;
  reply.trajectory = std::move(smoothed.trajectory);
}

void plan_tool(const PlanningCase& given, const SpeedAlong& people, const Pose& T_world_base,
               Result& result) {
  const auto& [robot, group, world, request, settings] = given;
  const Pose T_base_world = T_world_base.inverse();
  CartesianRequest wanted;
  wanted.start = request.start;
  wanted.also.assign(request.also.begin(), request.also.end());
  wanted.speed_scale = request.speed_scale;
  wanted.people = people.unconcerned() ? nullptr : &people;
  for (const TipNode& node : request.poses)
    wanted.nodes.push_back({T_base_world * node.T_world_tip,
                            node.has_elbow ? std::optional(node.elbow) : std::nullopt, node.also});
  if (request.upright)
    wanted.level =
        HeldLevel{request.upright_axis, T_base_world.linear() * Vector3::UnitZ(), request.max_tilt};
  if (!request.follower.empty())
    wanted.joined = JoinedArm{robot.group(request.follower), request.T_tip_follower};
  CartesianMotion motion = plan_cartesian(robot, group, world, wanted, settings.tool);
  TrajectoryReply& reply = result.reply;
  reply.solved = motion.solved;
  reply.reason = motion.reason;
  reply.reached = static_cast<std::uint32_t>(motion.reached);
  reply.duration_ptp = motion.duration_ptp;
  reply.axes.assign(motion.axes.begin(), motion.axes.end());
  reply.trajectory = std::move(motion.executable.approximation.trajectory);
  result.speeds = std::move(motion.speeds);
  result.cost = motion.cost;
  tell_speeds(request, result);
  for (BlendReport& corner : motion.corners)
    corner.node = static_cast<int>(motion.given[static_cast<std::size_t>(corner.node)]);
  report_stops(motion.corners, reply);
}

}  // namespace

Result plan(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost,
            const Surroundings& around, const TrajectoryRequest& request,
            const Settings& settings) {
  Result result;
  result.reply.id = request.id;
  if (!(result.reply.reason = why_bad(robot, request)).empty()) return result;
  const Group& group = *robot.group(request.group);
  const std::uint64_t checks_before = world.checks();
  const SpeedAlong people(robot, cost, around, settings.speed);
  const PlanningCase given{robot, group, world, request, settings};
  if (request.poses.empty()) {
    result.reply.axes.assign(group.axes.begin(), group.axes.end());
    plan_joints(given, cost, people, result);
  } else {
    plan_tool(given, people, around.T_world_base, result);
  }
  result.checks = world.checks() - checks_before;
  return result;
}

}  // namespace handsel::trajectory_planner
