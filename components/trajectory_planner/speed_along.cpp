// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/speed_along.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_planner {
namespace {

double in_steps(double factor) {
  constexpr double kStep = SpeedAlong::kStep;
  return std::max(kStep, kStep * std::floor(factor / kStep + 1e-9));
}

}  // namespace

SpeedAlong::SpeedAlong(const RobotModel& robot, const HumanCost& cost, const Surroundings& around,
                       const SpeedSettings& settings)
    : robot_(robot),
      cost_(cost),
      settings_(settings),
      T_world_base_(around.T_world_base),
      tool_(robot.tool_link() >= 0 ? robot.tool_link()
                                   : static_cast<int>(robot.links().size()) - 1) {
  for (const Person& person : around.people.people) {
    Someone someone;
    someone.body = simplified_body(person);
    if (const BodyJoint* torso = find_joint(person, "torso")) {
      someone.trunk = torso->position;
      someone.velocity = torso->velocity;
    }
    someone.sight = sight_of(person);
    someone_.push_back(someone);
  }
}

double SpeedAlong::behaviour_factor(const Vector& q) const {
  if (someone_.empty()) return 1;
  const Vector3 tool = (T_world_base_ * robot_.link_pose(q, tool_)).translation();
  double min_factor = 1;
  for (const Someone& someone : someone_) {
    const double distance = simplified_distance(someone.body, tool, tool, 0);
    const double near = std::clamp(2 * (1 - distance / settings_.concern_radius), 0.0, 1.0);
    if (near == 0) continue;
    const Vector3 to_tool = tool - someone.trunk;
    const double closing = someone.velocity.dot(to_tool) / std::max(to_tool.norm(), 1e-9);
    double unseen = 1;
    if (someone.sight) {
      const Vector3 sight = tool - someone.sight->eyes;
      const double angle = std::acos(std::clamp(
          sight.dot(someone.sight->direction) / std::max(sight.norm(), 1e-9), -1.0, 1.0));
      unseen =
          std::clamp(1 + (angle - settings_.unseen_angle) / settings_.unseen_transition, 0.0, 1.0);
    }
    min_factor =
        std::min(min_factor, (1 - (1 - settings_.approach_factor) * near *
                                      std::clamp(closing / settings_.approach_speed, 0.0, 1.0)) *
                                 (1 - (1 - settings_.unseen_factor) * near * unseen));
  }
  return min_factor;
}

LimitScale SpeedAlong::factor(double cost, const Vector& q) const {
  const double c = std::clamp(cost, 0.0, 1.0), people = behaviour_factor(q);
  const auto by_cost = [&](double min_factor) { return (1 - (1 - min_factor) * c) * people; };
  const LimitScale& min = settings_.min_factors;
  return {by_cost(min.velocity), by_cost(min.acceleration), by_cost(min.jerk)};
}

SpeedAlong::SpeedSample SpeedAlong::at(const Vector& q) const {
  if (unconcerned()) return {};
  const double cost = cost_(q);
  return {0, cost, factor(cost, q)};
}

std::vector<SpeedAlong::SpeedSample> SpeedAlong::along(const Vector& from, const Vector& to) const {
  const int parts =
      unconcerned() ? 1
                    : std::max(1, static_cast<int>(std::ceil((to - from).lpNorm<Eigen::Infinity>() /
                                                             settings_.cost_step)));
  std::vector<double> at, cost(static_cast<std::size_t>(parts) + 1);
  for (int k = 0; k <= parts; ++k) at.push_back(static_cast<double>(k) / parts);
  cost_.on_line(from, to, at.data(), parts + 1, cost.data());
  std::vector<SpeedSample> samples;
  for (std::size_t k = 0; k < at.size(); ++k)
    samples.push_back({at[k], cost[k],
                       unconcerned() ? LimitScale{} : factor(cost[k], from + at[k] * (to - from))});
  return samples;
}

LimitZones SpeedAlong::zones(const std::vector<SpeedSample>& samples) {
  LimitZones zones;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const LimitScale lower = samples[k].factor.lower(samples[k + 1].factor);
    const LimitScale factor{in_steps(lower.velocity), in_steps(lower.acceleration),
                            in_steps(lower.jerk)};
    if (!zones.empty() && zones.back().scale == factor)
      zones.back().end = samples[k + 1].at;
    else
      zones.push_back({samples[k + 1].at, factor});
  }
  return zones;
}

}  // namespace handsel::trajectory_planner
