// SPDX-License-Identifier: Apache-2.0
// Computes the smoothed trajectory of the active axes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/trajectory/limits_check.hpp"
#include "components/trajectory_planner/cartesian/cartesian_planning.hpp"

namespace handsel::trajectory_planner {

KinematicLimits CartesianPlanning::active_limits() const {
  const Eigen::Index n = motion_.path.nodes_[0].active.size();
  KinematicLimits out{Vector(n), Vector(n), Vector(n)};
  const auto set = [&](Eigen::Index i, const RateBounds& bounds) {
    out.velocity[i] = request_.speed_scale * bounds.velocity;
    out.acceleration[i] = bounds.acceleration;
    out.jerk[i] = bounds.jerk;
  };
  for (Eigen::Index i = 0; i < 3; ++i) set(i, settings_.translation);
  for (Eigen::Index i = 3; i < kTool; ++i) set(i, settings_.rotation);
  set(kTool, settings_.elbow);
  const KinematicLimits& joints = robot_.comfort_limits();
  for (std::size_t i = 0; i < request_.also.size(); ++i) {
    const int axis = request_.also[i];
    set(kElbow + static_cast<Eigen::Index>(i),
        {joints.velocity[axis], joints.acceleration[axis], joints.jerk[axis]});
  }
  return out;
}

bool CartesianPlanning::timed() {
  CartesianTrajectory& path = motion_.path;
  configurations_.clear();
  motion_.speeds.clear();
  motion_.cost = 0;
  ik::Axes q = RobotModel::part(request_.start, group_);
  configurations_.push_back(q);
  for (std::size_t k = 1; k < path.nodes_.size(); ++k) {
    std::vector<SpeedAlong::SpeedSample> samples;
    const auto next =
        along_segment(k - 1, path.nodes_[k - 1].active[kTool], path.nodes_[k].active[kTool], q,
                      request_.people != nullptr ? &samples : nullptr);
    if (!next) {
      end_before(given_[k], why_no_path(k));
      return false;
    }
    configurations_.push_back(q = *next);
    if (samples.empty()) continue;
    motion_.speeds.push_back(SpeedAlong::zones(samples));
    for (const SpeedAlong::SpeedSample& look : samples)
      motion_.cost = std::max(motion_.cost, std::clamp(look.cost, 0.0, 1.0));
  }
  std::vector<Vector> line;
  for (const Node& node : path.nodes_) line.push_back(node.active);
  const KinematicLimits limits = active_limits();
  SmoothSettings smoothing;
  smoothing.allowed_excess = settings_.allowed_excess;
  SmoothResult smoothed = smooth(
      line, limits, smoothing, [this](const Trajectory& corner) { return corner_free(corner); },
      motion_.speeds);
  if (!smoothed.ok()) {
    end_before(1, smoothed.reason);
    return true;
  }
  path.active_ = std::move(smoothed.trajectory);
  motion_.duration_ptp = smoothed.duration_ptp;
  motion_.corners = std::move(smoothed.corners);
  path.middles_.clear();
  double begin = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    for (const BlendReport& corner : motion_.corners)
      if (corner.node == static_cast<int>(k)) begin -= corner.saved;
    const double lasts = smoothed.segment_durations[k];
    path.middles_.push_back(begin + 0.5 * lasts);
    begin += lasts;
  }
  return true;
}

bool CartesianPlanning::corner_free(const Trajectory& corner) const {
  const std::size_t node = node_of(corner);
  if (node == 0 || joined_) return false;
  for (std::size_t i = 0; i < request_.also.size(); ++i) {
    const Axis& axis = robot_.axes()[static_cast<std::size_t>(request_.also[i])];
    const AxisExtremes e = extremes(corner.axes[kElbow + i]);
    if (e.lowest < axis.lower || e.highest > axis.upper) return false;
  }
  const double lasts = corner.duration();
  const Vector& at = motion_.path.nodes_[node].active;
  double middle = 0, min_distance = std::numeric_limits<double>::infinity();
  const int parts = std::max(8, static_cast<int>(std::ceil(lasts / (8 * settings_.period))));
  for (int k = 0; k <= parts; ++k)
    if (const double d = (corner.at(lasts * k / parts).position - at).norm(); d < min_distance) {
      min_distance = d;
      middle = lasts * k / parts;
    }
  for (const double end : {0.0, lasts}) {
    ik::Axes q = configurations_[node];
    std::vector<Vector> configurations;
    const int steps =
        std::max(1, static_cast<int>(std::ceil(std::abs(end - middle) / (4 * settings_.period))));
    for (int k = 0; k <= steps; ++k) {
      const Vector active = corner.at(middle + (end - middle) * k / steps).position;
      const Pose T = motion_.path.pose_at(active, node);
      const Vector also = active.tail(active.size() - kElbow);
      if (!held_upright(request_.level, T) ||
          !arm_->advance(T, active[kTool], also, settings_.largest_step, q))
        return false;
      configurations.push_back(whole(q, also));
    }
    if (first_touching(world_, configurations, settings_.collision_step) < configurations.size())
      return false;
  }
  return true;
}

std::size_t CartesianPlanning::node_of(const Trajectory& corner) const {
  const std::vector<Node>& nodes = motion_.path.nodes_;
  const Vector begin = corner.at(0).position, end = corner.at(corner.duration()).position;
  const auto distance_to_segment = [&](const Vector& x, std::size_t segment) {
    const Vector along = nodes[segment + 1].active - nodes[segment].active;
    const double factor = std::clamp(
        (x - nodes[segment].active).dot(along) / std::max(along.squaredNorm(), 1e-18), 0.0, 1.0);
    return (x - nodes[segment].active - factor * along).norm();
  };
  std::size_t best = 0;
  double min_distance = 1e-5;
  for (std::size_t k = 1; k + 1 < nodes.size(); ++k)
    if (const double d = distance_to_segment(begin, k - 1) + distance_to_segment(end, k);
        d < min_distance) {
      min_distance = d;
      best = k;
    }
  return best;
}

}  // namespace handsel::trajectory_planner
