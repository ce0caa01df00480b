// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/switch_planner.hpp"

#include <algorithm>
#include <cmath>

#include "common/collision/margins.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kCostStep = 0.1;  // samples of the cost along a trajectory [s]

/// Returns until when the trajectory has not been farther than `reach` from `from` [s].
double within_reach(const Trajectory& trajectory, const Vector& from, double reach) {
  constexpr int kSamples = 100;
  double last = 0.0;
  for (int k = 0; k <= kSamples; ++k) {
    const double t = trajectory.duration() * k / kSamples;
    if ((trajectory.at(t).position - from).cwiseAbs().maxCoeff() > reach) break;
    last = t;
  }
  return last;
}

}  // namespace

bool turns_back(const Switched& motion, const Trajectory& onto) {
  return motion.ok() && motion.trajectory.duration() > onto.duration();
}

Switched SwitchPlanner::join(const MotionState3& from, const Trajectory& to,
                             const SwitchCandidate& candidate) const {
  KinematicLimits limits = robot_->comfort_limits();
  for (Vector* part : {&limits.velocity, &limits.acceleration, &limits.jerk})
    *part = bounds_.reserve * RobotModel::part(*part, arm_);
  if (candidate.speed < 1) {
    const Vector present = limits.velocity.cwiseMin(bounds_.reserve * from.velocity.cwiseAbs());
    limits.velocity = (candidate.speed * limits.velocity).cwiseMax(present);
  }
  SwitchSettings settings;
  settings.reserve = bounds_.reserve;
  settings.last = within_reach(to, from.position, candidate.max_reach);
  return switch_to(from, to, limits, settings);
}

bool SwitchPlanner::is_within_limits(const Vector& joints) const {
  for (int i = 0; i < joints.size(); ++i) {
    const Axis& axis =
        robot_->axes()[static_cast<std::size_t>(arm_.axes[static_cast<std::size_t>(i)])];
    if (joints[i] < axis.lower || joints[i] > axis.upper) return false;
  }
  return true;
}

bool SwitchPlanner::is_upright(const Vector& q, const PlanningSnapshot& now) const {
  if (!now.tilt || now.palm < 0) return true;
  const Pose T_world_palm = now.scene.T_world_base * robot_->link_pose(q, now.palm);
  const Vector3 axis = T_world_palm.linear() * now.tilt->axis_tool;
  return axis.z() >= std::cos(now.tilt->max_tilt);
}

bool SwitchPlanner::is_free(CollisionWorld& world, const Switched& motion,
                            const PlanningSnapshot& now) const {
  double rate =
      bounds_.reserve * RobotModel::part(robot_->comfort_limits().velocity, arm_).maxCoeff();
  for (const AxisTrajectory& axis : motion.trajectory.axes)
    rate = std::max(rate, std::abs(axis.start.velocity));
  // Behind the connecting motion the path is known to be free, but its blends are not.
  const double whole = motion.trajectory.duration(), connecting = motion.connecting;
  const int first = std::max(2, static_cast<int>(std::ceil(rate * connecting / bounds_.step)));
  const int steps =
      first +
      static_cast<int>(std::ceil(rate * std::max(0.0, whole - connecting) / bounds_.rest_step));
  for (int k = 0; k <= steps; ++k) {
    const double t = k <= first ? connecting * k / first
                                : connecting + (whole - connecting) * (k - first) / (steps - first);
    const Vector joints = motion.trajectory.at(t).position;
    const Vector q = RobotModel::with(now.q, arm_, joints);
    if (!is_within_limits(joints) || !is_upright(q, now) || !world.is_free(q)) return false;
  }
  return true;
}

std::optional<Trajectory> SwitchPlanner::free_motion(CollisionWorld& world,
                                                     const PlanningSnapshot& now,
                                                     const MotionState3& from,
                                                     const SwitchCandidate& candidate) const {
  const Trajectory& to = *candidate.onto;
  const Switched motion = join(from, to, candidate);
  if (!motion.ok()) return std::nullopt;
  world.set_scene(now.scene);
  world.set_people(now.people);
  world.set_attachment(now.attachment, now.allowed);
  world.set_moving_axes(arm_.axes);
  const Vector q_start = RobotModel::with(now.q, arm_, from.position);
  const Vector q_end = RobotModel::with(now.q, arm_, to.at(to.duration()).position);
  set_scene_with_margins(world, now.scene, {bounds_.margin, bounds_.margin}, {q_start, q_end});
  if (!is_free(world, motion, now)) return std::nullopt;
  return motion.trajectory;
}

double SwitchPlanner::cost_at(const HumanCost& cost, const Vector& joints,
                              const Vector& q_other) const {
  return cost(RobotModel::with(q_other, arm_, joints));
}

/// Returns the integral along the trajectory of the human-aware cost above `level` [rad].
double SwitchPlanner::cost_along(const HumanCost& cost, const Trajectory& trajectory,
                                 const Vector& q_other, double level) const {
  const int samples = std::max(1, static_cast<int>(std::ceil(trajectory.duration() / kCostStep)));
  double sum = 0;
  for (int k = 0; k < samples; ++k) {
    const auto at = [&](double sample) {
      return trajectory.at(trajectory.duration() * sample / samples).position;
    };
    sum += std::max(0.0, cost_at(cost, at(k + 0.5), q_other) - level) * (at(k + 1) - at(k)).norm();
  }
  return sum;
}

void SwitchPlanner::evaluate(SwitchCandidate& candidate, CollisionWorld& world, HumanCost& cost,
                             const PlanningSnapshot& now, const SwitchPoint& point) const {
  const double from_rest = candidate.onto->duration();
  const MotionState3& from = point.from;
  if (!point.at_rest) {
    candidate.onto = free_motion(world, now, from, candidate);
    if (candidate.along) {
      Switched along = join(from, *candidate.along, candidate);
      if (along.ok() && !turns_back(along, *candidate.along))
        candidate.along = std::move(along.trajectory);
    }
  }
  if (!candidate.onto || !candidate.along) return;
  cost.set_people(now.people);
  cost.set_layers(now.layers);
  cost.set_base(now.scene.T_world_base);
  // The cost of the cheapest end is left out: every motion between these ends has it.
  double level = cost_at(cost, from.position, now.q);
  for (const Trajectory* trajectory : {&*candidate.onto, &*candidate.along})
    level = std::min(level, cost_at(cost, trajectory->at(trajectory->duration()).position, now.q));
  const double before = cost_along(cost, *candidate.along, now.q, level);
  const double saved =
      before > 0 ? now.cost_gain * (1 - cost_along(cost, *candidate.onto, now.q, level) / before)
                 : 0;
  const double max_duration =
      std::min(from_rest, (1 + bounds_.max_slower * saved) * candidate.along->duration());
  candidate.is_worth = saved >= bounds_.min_saved && candidate.onto->duration() <= max_duration;
}

}  // namespace handsel::manipulation_planner
