// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/cartesian/cartesian_arm.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/platform.hpp"

namespace handsel::trajectory_planner {

CartesianArm::CartesianArm(const RobotModel& robot, const Group& group,
                           const CartesianRequest& request)
    : robot_(robot), request_(request), chain_(robot, group, request.start) {
  if (const Group* platform = robot_.group(kPlatformGroup))
    for (std::size_t i = 0; i < platform_.size(); ++i) platform_[i] = further(platform->axes[i]);
  T_root_base_ = base_at(request_.start(request_.also));
  arm_ = ik::SrsArm::recognise(chain_);
}

int CartesianArm::further(int axis) const {
  const auto found = std::find(request_.also.begin(), request_.also.end(), axis);
  return found == request_.also.end() ? -1 : static_cast<int>(found - request_.also.begin());
}

Pose CartesianArm::base_at(const Vector& also) const {
  if (!drives()) return Pose::Identity();
  const std::vector<int>& axes = robot_.require_group(kPlatformGroup).axes;
  const auto at = [&](std::size_t i) {
    return platform_[i] < 0 ? request_.start[axes[i]] : also[platform_[i]];
  };
  return make_pose({at(0), at(1), 0},
                   Eigen::Quaterniond(Eigen::AngleAxisd(at(2), Vector3::UnitZ())));
}

Pose CartesianArm::for_arm(const Pose& T_root_tool, const Vector& also) const {
  return drives() ? T_root_base_ * base_at(also).inverse() * T_root_tool : T_root_tool;
}

double CartesianArm::near_limits(const ik::Axes& q) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double middle = 0.5 * (chain_.lower()[i] + chain_.upper()[i]),
                 half = 0.5 * (chain_.upper()[i] - chain_.lower()[i]);
    sum += std::pow((q[i] - middle) / half, 6);
  }
  return sum;
}

bool CartesianArm::advance(const Pose& T, double elbow, const Vector& also, double largest_step,
                           ik::Axes& q) const {
  const auto next = arm_->nearest(for_arm(T, also), elbow, q);
  if (!next || (*next - q).lpNorm<Eigen::Infinity>() > largest_step) return false;
  q = *next;
  return true;
}

}  // namespace handsel::trajectory_planner
