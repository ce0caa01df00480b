// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/head/gaze.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"

namespace handsel::trajectory_controller {

namespace {

/// Returns the residual: direction to the point minus viewing direction.
Vector3 miss(const RobotModel& robot, const Vector& q, const Vector3& p_root) {
  const Pose T = robot.link_pose(q, robot.gaze_link());
  return (p_root - T.translation()).normalized() - T.linear().col(0);
}

/// Returns the links moved by an axis for which `moves` is true.
template <class Moves>
std::vector<bool> moved_links(const RobotModel& robot, const Moves& moves) {
  std::vector<bool> moved(robot.links().size(), false);
  for (bool found = true; found;) {
    found = false;
    for (const Joint& joint : robot.joints()) {
      const auto parent = static_cast<std::size_t>(joint.parent),
                 child = static_cast<std::size_t>(joint.child);
      if (moved[child] || !(moved[parent] || (joint.dof >= 0 && moves(joint.dof)))) continue;
      moved[child] = found = true;
    }
  }
  return moved;
}

}  // namespace

std::vector<double> aim(const RobotModel& robot, const Group& head, const Vector& q,
                        const Vector3& p_root) {
  Vector x = q;
  const auto n = static_cast<Eigen::Index>(head.axes.size());
  if (robot.gaze_link() >= 0 && n > 0 &&
      (p_root - robot.link_pose(q, robot.gaze_link()).translation()).norm() > 0.05) {
    constexpr int kIterations = 12;
    constexpr double kStep = 1e-4, kDamping = 1e-4, kMaxStep = 0.5;
    Eigen::MatrixXd J(3, n);
    for (int k = 0; k < kIterations; ++k) {
      const Vector3 e = miss(robot, x, p_root);
      if (e.norm() < 1e-4) break;
      for (Eigen::Index i = 0; i < n; ++i) {
        Vector moved = x;
        moved[head.axes[static_cast<std::size_t>(i)]] += kStep;
        J.col(i) = (miss(robot, moved, p_root) - e) / kStep;
      }
      const Vector dx = -(J.transpose() * J + kDamping * Eigen::MatrixXd::Identity(n, n))
                             .ldlt()
                             .solve(J.transpose() * e);
      for (Eigen::Index i = 0; i < n; ++i) {
        const int axis = head.axes[static_cast<std::size_t>(i)];
        const Axis& bounds = robot.axes()[static_cast<std::size_t>(axis)];
        x[axis] = std::clamp(x[axis] + std::clamp(dx[i], -kMaxStep, kMaxStep), bounds.lower,
                             bounds.upper);
      }
    }
  }
  std::vector<double> out;
  for (int axis : head.axes) out.push_back(x[axis]);
  return out;
}

HeadRoom::HeadRoom(const RobotModel& robot, double min_clearance)
    : robot_(robot),
      min_clearance_(min_clearance),
      head_(robot.group("head")),
      capsules_(robot_capsules(robot)) {
  if (head_ == nullptr) return;
  const auto turns_head = [&](int axis) {
    return std::find(head_->axes.begin(), head_->axes.end(), axis) != head_->axes.end();
  };
  const std::vector<bool> of_head = moved_links(robot, turns_head),
                          others = moved_links(robot, [&](int a) { return !turns_head(a); });
  for (std::size_t a = 0; a < capsules_.size(); ++a)
    for (std::size_t b = 0; b < capsules_.size(); ++b) {
      const int head_link = capsules_[a].link, other = capsules_[b].link;
      const bool both =
          of_head[static_cast<std::size_t>(head_link)] && others[static_cast<std::size_t>(other)];
      if (both && !of_head[static_cast<std::size_t>(other)] &&
          !robot.pair_disabled(head_link, other))
        pairs_.emplace_back(a, b);
    }
}

double HeadRoom::clearance(const Vector& q) {
  double min_clearance = std::numeric_limits<double>::infinity();
  if (pairs_.empty()) return min_clearance;
  robot_.forward(q, T_root_link_);
  for (const auto& [a, b] : pairs_) {
    const LinkCapsule &head = capsules_[a], &other = capsules_[b];
    const Pose &T = T_root_link_[static_cast<std::size_t>(head.link)],
               &U = T_root_link_[static_cast<std::size_t>(other.link)];
    Vector3 on_head, on_other;
    const double apart2 =
        nearest_points(T * head.a, T * head.b, U * other.a, U * other.b, on_head, on_other);
    min_clearance = std::min(min_clearance, std::sqrt(apart2) - head.radius - other.radius);
  }
  return min_clearance;
}

double HeadRoom::min_clearance(const Vector& q) {
  constexpr double kSame = 1e-3;  // [m]
  return std::min(min_clearance_, clearance(q) - kSame);
}

bool HeadRoom::lets_turn(const Vector& q, const std::vector<double>& target) {
  constexpr int kSamples = 4;
  if (pairs_.empty()) return true;
  const double min_kept = min_clearance(q);
  Vector x = q;
  for (int k = 1; k <= kSamples; ++k) {
    for (std::size_t i = 0; i < head_->axes.size(); ++i)
      x[head_->axes[i]] += (target[i] - q[head_->axes[i]]) / kSamples;
    if (clearance(x) < min_kept) return false;
  }
  return true;
}

bool HeadRoom::lets_be(const Vector& q, const std::vector<double>& target) {
  if (pairs_.empty()) return true;
  Vector x = q;
  for (std::size_t i = 0; i < head_->axes.size(); ++i) x[head_->axes[i]] = target[i];
  return clearance(x) >= min_clearance(q);
}

}  // namespace handsel::trajectory_controller
