// SPDX-License-Identifier: Apache-2.0
// Waypoints of a Cartesian motion and their elbow angles.
#include <algorithm>
#include <cmath>
#include <limits>

#include "components/trajectory_planner/cartesian/cartesian_planning.hpp"

namespace handsel::trajectory_planner {
namespace {

constexpr double kMinFromPi = 0.02;  // min distance from pi of the angle of a segment [rad]
constexpr double kSame = 1e-9;       // max distance of equal waypoints
constexpr double kProbe = 0.05;      // step of the tested motion between elbow angles [rad]
constexpr double kMetre = 3.0;       // weight of the tool's translation in this step [rad/m]
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Vector3 displacement(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(from.transpose() * to));
  return turn.angle() * turn.axis();
}

}  // namespace

void CartesianPlanning::find_nodes() {
  const ik::Axes q = RobotModel::part(request_.start, group_);
  Node at;
  at.T_root_tool = arm_->chain().forward(q, nullptr);
  at.active = Vector::Zero(kElbow + static_cast<Eigen::Index>(request_.also.size()));
  at.active.head<3>() = at.T_root_tool.translation();
  at.active[kTool] = arm_->srs().elbow_angle(q);
  for (std::size_t i = 0; i < request_.also.size(); ++i)
    at.active[kElbow + static_cast<Eigen::Index>(i)] = request_.start[request_.also[i]];
  motion_.path.nodes_ = {at};
  given_ = {0};
  if (!held_upright(request_.level, at.T_root_tool))
    return end_before(1, "at the start what is held leans over too far");
  for (std::size_t k = 1; k <= request_.nodes.size(); ++k) {
    const CartesianWaypoint& wanted = request_.nodes[k - 1];
    const Node& last = motion_.path.nodes_.back();
    const Vector3 turn = displacement(last.T_root_tool.linear(), wanted.T_root_tool.linear());
    if (turn.norm() > M_PI - kMinFromPi)
      return end_before(k, "the tool turns by half a turn from " + node_name(k - 1) + " to " +
                               node_name(k) +
                               ", about no axis in particular: a node between is needed");
    if (!held_upright(request_.level, wanted.T_root_tool))
      return end_before(k, "at " + node_name(k) + " what is held leans over too far");
    Node next;
    next.T_root_tool = wanted.T_root_tool;
    next.active = last.active;
    next.active.head<3>() = wanted.T_root_tool.translation();
    next.active.segment<3>(3) += turn;
    if (wanted.elbow)
      next.active[kTool] += std::remainder(*wanted.elbow - last.active[kTool], 2 * M_PI);
    next.active.tail(wanted.also.size()) = wanted.also;
    for (std::size_t i = 0; i < request_.also.size(); ++i) {
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(request_.also[i])];
      const double value = wanted.also[static_cast<Eigen::Index>(i)];
      if (!(value >= axis.lower && value <= axis.upper))
        return end_before(
            k, formatted("at node %zu axis %s at %.4f is outside its limits %.4f ... %.4f", k,
                         axis.name.c_str(), value, axis.lower, axis.upper));
    }
    motion_.reached = k;
    const bool settles_elbow =
        wanted.elbow && given_.back() > 0 && !request_.nodes[given_.back() - 1].elbow;
    if (!settles_elbow && (next.active - last.active).lpNorm<Eigen::Infinity>() <= kSame) continue;
    motion_.path.nodes_.push_back(next);
    given_.push_back(k);
  }
}

std::optional<ik::Axes> CartesianPlanning::along_segment(
    std::size_t segment, double elbow_from, double elbow_to, const ik::Axes& from,
    std::vector<SpeedAlong::SpeedSample>* samples) const {
  const Node &a = motion_.path.nodes_[segment], &b = motion_.path.nodes_[segment + 1];
  const Vector step = b.active - a.active;
  const double far = std::max(
      {kMetre * step.head<3>().norm(), step.segment<3>(3).norm(), std::abs(elbow_to - elbow_from)});
  const int parts = std::max(1, static_cast<int>(std::ceil(far / kProbe)));
  ik::Axes q = from;
  const auto add_sample = [&](double factor) {
    if (samples == nullptr) return;
    samples->push_back(request_.people->at(whole(
        q, a.active.tail(a.active.size() - kElbow) + factor * step.tail(step.size() - kElbow))));
    samples->back().at = factor;
  };
  add_sample(0);
  for (int k = 1; k <= parts; ++k) {
    const double factor = static_cast<double>(k) / parts;
    const Vector active = a.active + factor * step;
    const Pose T =
        arm_->for_arm(motion_.path.pose_at(active, segment), active.tail(active.size() - kElbow));
    const auto next = arm_->srs().nearest(T, elbow_from + factor * (elbow_to - elbow_from), q);
    if (!next || (*next - q).lpNorm<Eigen::Infinity>() > 4 * settings_.largest_step)
      return std::nullopt;
    q = *next;
    add_sample(factor);
  }
  return q;
}

void CartesianPlanning::choose_elbows() {
  std::vector<Node>& nodes = motion_.path.nodes_;
  struct Option {
    double elbow{}, cost{kInfinite};
    ik::Axes q;
  };
  std::vector<Option> from{{nodes[0].active[kTool], 0.0, RobotModel::part(request_.start, group_)}};
  std::vector<std::vector<std::pair<double, int>>> chosen{{{from[0].elbow, -1}}};
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const std::optional<double>& fixed = request_.nodes[given_[k] - 1].elbow;
    std::vector<Option> to;
    std::vector<std::pair<double, int>> origins;
    const int tries = fixed ? 1 : settings_.elbows;
    for (int i = 0; i < tries; ++i) {
      const double angle = fixed ? *fixed : nodes[0].active[kTool] + 2 * M_PI * i / tries;
      std::vector<std::pair<double, int>> order;
      for (std::size_t j = 0; j < from.size(); ++j)
        order.emplace_back(
            from[j].cost +
                settings_.elbow_weight * std::abs(std::remainder(angle - from[j].elbow, 2 * M_PI)),
            static_cast<int>(j));
      std::sort(order.begin(), order.end());
      for (std::size_t j = 0; j < std::min<std::size_t>(3, order.size()); ++j) {
        const Option& before = from[static_cast<std::size_t>(order[j].second)];
        const double elbow = before.elbow + std::remainder(angle - before.elbow, 2 * M_PI);
        const std::optional<ik::Axes> q =
            along_segment(k - 1, before.elbow, elbow, before.q, nullptr);
        if (!q) continue;
        to.push_back({elbow, order[j].first + arm_->near_limits(*q), *q});
        origins.emplace_back(elbow, order[j].second);
        break;
      }
    }
    if (to.empty()) {
      end_before(given_[k], why_no_path(k));
      break;
    }
    from = std::move(to);
    chosen.push_back(std::move(origins));
  }
  std::size_t best = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    if (from[i].cost < from[best].cost) best = i;
  for (std::size_t k = nodes.size() - 1; k > 0; --k) {
    nodes[k].active[kTool] = chosen[k][best].first;
    best = static_cast<std::size_t>(chosen[k][best].second);
  }
}

std::string CartesianPlanning::why_no_path(std::size_t k) const {
  const Node& node = motion_.path.nodes_[k];
  const ik::Axes middle = 0.5 * (arm_->chain().lower() + arm_->chain().upper());
  bool reach = false, inside = false;
  for (int i = 0; i < settings_.elbows; ++i) {
    const double elbow = node.active[kTool] + 2 * M_PI * i / settings_.elbows;
    const std::vector<ik::Axes> found = arm_->srs().branches(
        arm_->for_arm(node.T_root_tool, node.active.tail(node.active.size() - kElbow)), elbow);
    reach |= !found.empty();
    inside |= std::any_of(found.begin(), found.end(), [&](const ik::Axes& q) {
      return arm_->srs().turned_inside(q, middle).has_value();
    });
  }
  const std::string name = node_name(given_[k]);
  if (!reach) return name + " is out of reach of the arm";
  if (!inside) return "no configuration inside the joint limits has the tool at " + name;
  return "no path leads to " + name +
         " without a joint limit or a change of branch (a stretched shoulder, elbow or wrist) "
         "between";
}

}  // namespace handsel::trajectory_planner
