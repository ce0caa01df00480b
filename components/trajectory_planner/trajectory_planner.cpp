#include "components/trajectory_planner/trajectory_planner.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/segment_table.hpp"
#include "common/trajectory/smooth.hpp"
#include "components/trajectory_planner/motion_judge.hpp"

namespace handsel::trajectory_planner {
namespace {

std::string why_bad(const RobotModel& robot, const TrajectoryRequest& request) {
  const Group* group = robot.group(request.group);
  if (group == nullptr) return "the robot has no group \"" + request.group + "\"";
  if (request.start.size() != robot.dof()) {
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot " + std::to_string(robot.dof());
  }
  if (!request.start.allFinite()) return "the start has a number that is not finite";
  if (request.nodes.empty()) return "there are no nodes";
  for (const Vector& node : request.nodes) {
    if (node.size() != static_cast<Eigen::Index>(group->axes.size())) {
      return "a node has " + std::to_string(node.size()) + " axes, the group \"" + request.group + "\" " +
             std::to_string(group->axes.size());
    }
  }
  if (!(request.speed_scale > 0 && request.speed_scale <= 1)) return "speed_scale must be in (0, 1]";
  return {};
}

KinematicLimits comfort_limits(const RobotModel& robot, const Group& group, double speed_factor) {
  const KinematicLimits& all = robot.comfort_limits();
  return {RobotModel::part(all.velocity, group) * speed_factor, RobotModel::part(all.acceleration, group),
          RobotModel::part(all.jerk, group)};
}

double largest_cost(const HumanCost& cost, const TrajectoryRequest& request, const Group& group, double step) {
  if (!cost.concerned()) return 0;
  double worst = 0;
  for (std::size_t k = 0; k + 1 < request.nodes.size(); ++k) {
    const Vector &a = request.nodes[k], &b = request.nodes[k + 1];
    const int parts = std::max(1, static_cast<int>(std::ceil((b - a).lpNorm<Eigen::Infinity>() / step)));
    for (int i = k == 0 ? 0 : 1; i <= parts; ++i) {
      worst = std::max(worst, cost(RobotModel::with(request.start, group, a + (b - a) * (static_cast<double>(i) / parts))));
    }
  }
  return std::clamp(worst, 0.0, 1.0);
}

/// Judges corners: position limits on the exact extremes, collisions along the way.
class CornerJudge {
 public:
  CornerJudge(const RobotModel& robot, const Group& group, CollisionWorld& world, const HumanCost& cost, const Vector& start, double step)
      : robot_(robot),
        group_(group),
        cost_(cost),
        start_(start),
        step_(step),
        bound_(cost.forbids() && cost.forbidden(start).layer == nullptr),
        motion_(world, group.axes, start) {}

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
      if (cost_.forbidden(RobotModel::with(start_, group_, state.position)).layer != nullptr) return false;
    }
    return true;
  }

 private:
  const RobotModel& robot_;
  const Group& group_;
  const HumanCost& cost_;
  const Vector& start_;
  double step_;
  bool bound_;  // by what outside layers forbid: not when it starts there
  MotionJudge motion_;
};

}  // namespace

Result plan(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const TrajectoryRequest& request,
            const Settings& settings) {
  Result result;
  TrajectoryReply& reply = result.reply;
  reply.id = request.id;
  if (!(reply.reason = why_bad(robot, request)).empty()) return result;
  const Group& group = *robot.group(request.group);
  result.cost = largest_cost(cost, request, group, settings.cost_step);
  result.speed_factor = request.speed_scale * (1 - (1 - settings.least_speed_factor) * result.cost);
  const KinematicLimits limits = comfort_limits(robot, group, result.speed_factor);
  const std::uint64_t checks_before = world.checks();
  CornerJudge judge(robot, group, world, cost, request.start, settings.corner_step);
  SmoothSettings smoothing;
  smoothing.allowed_excess = settings.allowed_excess;
  SmoothResult smoothed = smooth(request.nodes, limits, smoothing, [&judge](const Trajectory& corner) { return judge(corner); });
  result.checks = world.checks() - checks_before;
  if (!(reply.reason = smoothed.reason).empty()) return result;
  for (const CornerReport& corner : smoothed.corners) {
    if (corner.method == CornerMethod::stop) reply.corners.push_back({"corner " + std::to_string(corner.node), corner.reason});
  }
  reply.solved = true;
  reply.duration_ptp = smoothed.duration_ptp;
  reply.trajectory = std::move(smoothed.trajectory);
  return result;
}

}  // namespace handsel::trajectory_planner
