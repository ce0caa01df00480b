// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/robot_joints.hpp"

#include <algorithm>

namespace handsel::ros2_lane {
namespace {
constexpr double kMinStep = 1e-4;  // min time between two positions for a velocity [s]
}  // namespace

ros2::JointState joint_state_of(const RobotModel& robot, const RobotState& state) {
  ros2::JointState out;
  out.stamp = state.stamp;
  for (const Axis& axis : robot.axes()) out.names.push_back(axis.name);
  out.position = state.position;
  out.velocity = state.velocity;
  out.effort = state.effort;
  return out;
}

void add_links(const RobotModel& robot, const RobotState& state, const std::string& world,
               std::vector<ros2::Transform>& out) {
  std::vector<Pose> T_root_link;
  robot.forward(state.position, T_root_link);
  out.push_back({state.stamp, world, robot.links().front().name, state.T_world_base});
  for (std::size_t i = 1; i < robot.links().size(); ++i) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(robot.links()[i].parent_joint)];
    const auto parent = static_cast<std::size_t>(joint.parent);
    out.push_back({state.stamp, robot.links()[parent].name, robot.links()[i].name,
                   T_root_link[parent].inverse() * T_root_link[i]});
  }
}

JointGatherer::JointGatherer(const RobotModel& robot, double max_age)
    : robot_(robot), max_age_(from_seconds(max_age)), axes_(robot.axes().size()) {}

void JointGatherer::on(const ros2::JointState& message, TimePoint arrival) {
  if (message.position.size() == 0) return;
  for (std::size_t i = 0; i < message.names.size(); ++i) {
    const auto axis = std::find_if(robot_.axes().begin(), robot_.axes().end(),
                                   [&](const Axis& a) { return a.name == message.names[i]; });
    if (axis == robot_.axes().end()) continue;
    Reported& reported = axes_[static_cast<std::size_t>(axis - robot_.axes().begin())];
    const double position = message.position[static_cast<Eigen::Index>(i)];
    const double dt = to_seconds(message.stamp != 0 ? Duration(message.stamp - reported.stamp)
                                 : reported.arrival ? arrival - *reported.arrival
                                                    : Duration::zero());
    if (message.velocity.size() > 0)
      reported.velocity = message.velocity[static_cast<Eigen::Index>(i)];
    else if (reported.arrival && dt > kMinStep)
      reported.velocity = (position - reported.position) / dt;
    reported.position = position;
    reported.stamp = message.stamp;
    reported.arrival = arrival;
  }
  stamp_ = std::max(stamp_, message.stamp);
}

std::string JointGatherer::missing(TimePoint now) const {
  std::string out;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (!axes_[i].arrival || now - *axes_[i].arrival > max_age_)
      out += (out.empty() ? "" : ", ") + robot_.axes()[i].name;
  return out;
}

std::optional<RobotState> JointGatherer::state(TimePoint now) {
  if (!missing(now).empty()) return std::nullopt;
  RobotState out;
  out.stamp = stamp_;
  out.robot = robot_.name();
  out.sequence = ++sequence_;
  out.position.resize(robot_.dof());
  out.velocity.resize(robot_.dof());
  for (int i = 0; i < robot_.dof(); ++i) {
    out.position[i] = axes_[static_cast<std::size_t>(i)].position;
    out.velocity[i] = axes_[static_cast<std::size_t>(i)].velocity;
  }
  out.mode = DriveMode::enabled;
  return out;
}

}  // namespace handsel::ros2_lane
