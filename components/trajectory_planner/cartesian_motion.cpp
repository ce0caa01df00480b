// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/cartesian_motion.hpp"

#include <algorithm>
#include <cmath>

#include "components/trajectory_planner/cartesian/cartesian_planning.hpp"

namespace handsel::trajectory_planner {
namespace {

Eigen::Matrix3d turned_by(const Vector3& r) {
  const double angle = r.norm();
  return angle < 1e-12 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                       : Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

}  // namespace

Pose CartesianTrajectory::pose_at(const Vector& active, std::size_t node) const {
  const Node& at = nodes_[node];
  Pose T = Pose::Identity();
  T.translation() = active.head<3>();
  T.linear() = at.T_root_tool.linear() * turned_by(active.segment<3>(3) - at.active.segment<3>(3));
  return T;
}

std::size_t CartesianTrajectory::node_at(double t) const {
  return static_cast<std::size_t>(std::upper_bound(middles_.begin(), middles_.end(), t) -
                                  middles_.begin());
}

Pose CartesianTrajectory::pose(double t) const {
  return pose_at(active_.at(t).position, node_at(t));
}

CartesianMotion CartesianPlanning::run() {
  if (!possible()) return std::move(motion_);
  find_nodes();
  choose_elbows();
  while (!timed() || !followed()) {
  }
  motion_.given = given_;
  if (motion_.reached == 0 && !motion_.reason.empty()) return std::move(motion_);
  approximated();
  motion_.solved = motion_.reason.empty();
  return std::move(motion_);
}

bool CartesianPlanning::refuse(const std::string& why) {
  if (motion_.reason.empty()) motion_.reason = why;
  return false;
}

void CartesianPlanning::end_before(std::size_t given, const std::string& why) {
  refuse(why);
  while (given_.size() > 1 && given_.back() >= given) {
    given_.pop_back();
    motion_.path.nodes_.pop_back();
    configurations_.resize(std::min(configurations_.size(), given_.size()));
  }
  motion_.reached = given_.back();
}

bool CartesianPlanning::possible() {
  if (request_.start.size() != robot_.dof() || !request_.start.allFinite())
    return refuse(formatted("the start has %d axes, the robot %d",
                            static_cast<int>(request_.start.size()), robot_.dof()));
  if (request_.nodes.empty()) return refuse("there are no nodes");
  if (!(request_.speed_scale > 0 && request_.speed_scale <= 1))
    return refuse("the speed scale must be in (0, 1]");
  for (const int axis : request_.also)
    if (axis < 0 || axis >= robot_.dof() ||
        std::count(group_.axes.begin(), group_.axes.end(), axis) > 0)
      return refuse(
          "axis " + std::to_string(axis) + " cannot be active besides the arm" +
          (axis >= robot_.dof() ? ": the robot has " + std::to_string(robot_.dof()) : ""));
  for (std::size_t k = 0; k < request_.nodes.size(); ++k) {
    const CartesianWaypoint& node = request_.nodes[k];
    if (!node.T_root_tool.matrix().allFinite() || (node.elbow && !std::isfinite(*node.elbow)) ||
        !node.also.allFinite())
      return refuse(node_name(k + 1) + " has a number that is not finite");
    if (node.also.size() != static_cast<Eigen::Index>(request_.also.size()))
      return refuse(node_name(k + 1) + " gives " + std::to_string(node.also.size()) +
                    " further axes, the request names " + std::to_string(request_.also.size()));
  }
  arm_.emplace(robot_, group_, request_);
  if (!arm_->recognised()) return refuse(ik::SrsArm::why_none(group_));
  motion_.axes = group_.axes;
  motion_.axes.insert(motion_.axes.end(), request_.also.begin(), request_.also.end());
  if (!join()) return false;
  world_.set_moving_axes(axes_that_move());
  if (const CollisionVerdict verdict = world_.check(request_.start); !verdict.free)
    return refuse("the start is in collision: " + verdict.first + " touches " + verdict.second);
  return true;
}

bool CartesianPlanning::join() {
  if (!request_.joined) return true;
  for (const int axis : request_.joined->arm->axes)
    if (std::count(motion_.axes.begin(), motion_.axes.end(), axis) > 0)
      return refuse("the arm " + request_.joined->arm->name +
                    " cannot follow itself, nor axes that are active");
  joined_.emplace(robot_, *request_.joined, request_.start);
  if (std::string why = joined_->objection(
          arm_->chain().forward(RobotModel::part(request_.start, group_), nullptr));
      !why.empty())
    return refuse(why);
  motion_.axes.insert(motion_.axes.end(), joined_->axes().begin(), joined_->axes().end());
  return true;
}

std::vector<int> CartesianPlanning::axes_that_move() const {
  std::vector<int> axes = group_.axes;
  for (std::size_t i = 0; i < request_.also.size(); ++i)
    if (std::any_of(
            request_.nodes.begin(), request_.nodes.end(), [&](const CartesianWaypoint& node) {
              return node.also[static_cast<Eigen::Index>(i)] != request_.start[request_.also[i]];
            }))
      axes.push_back(request_.also[i]);
  if (joined_) axes.insert(axes.end(), joined_->axes().begin(), joined_->axes().end());
  return axes;
}

Vector CartesianPlanning::whole(const ik::Axes& q, const Vector& also) const {
  Vector all = RobotModel::with(request_.start, group_, q);
  for (std::size_t i = 0; i < request_.also.size(); ++i)
    all[request_.also[i]] = also[static_cast<Eigen::Index>(i)];
  if (joined_) all(joined_->axes()) = joined_->joints();
  return all;
}

CartesianMotion plan_cartesian(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                               const CartesianRequest& request, const CartesianSettings& settings) {
  return CartesianPlanning(robot, arm, world, request, settings).run();
}

}  // namespace handsel::trajectory_planner
