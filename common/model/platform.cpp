// SPDX-License-Identifier: Apache-2.0
#include "common/model/platform.hpp"

#include <cmath>

#include "common/model/description/robot_model_builder.hpp"
#include "common/model/description/robot_text.hpp"

namespace handsel {
namespace {

constexpr int kAdded = 3;             // number of axes, joints and links added
constexpr double kMaxHeading = 40.0;  // max heading [rad]
// Max force of the drives and wheels as a fraction of the weight, and the lever of the resulting
// torque.
constexpr double kTraction = 0.5, kTractionLever = 0.3;  // [1], [m]
constexpr double kGravity = 9.81;                        // [m/s^2]

Vector longer(const Vector& of_robot, double linear, double angular) {
  Vector out(of_robot.size() + kAdded);
  out << of_robot, linear, linear, angular;
  return out;
}

/// Ratios of platform speeds, accelerations and jerks to the comfort speeds.
struct PlatformRatios {
  double velocity, acceleration, jerk;
};
constexpr PlatformRatios kComfort{1.0, 2.0, 6.0};
constexpr PlatformRatios kGuard{1.1, 6.0, 60.0};  // also for stops

KinematicLimits longer(const KinematicLimits& of_robot, double speed, double turn_speed,
                       const PlatformRatios& ratios) {
  return {
      longer(of_robot.velocity, ratios.velocity * speed, ratios.velocity * turn_speed),
      longer(of_robot.acceleration, ratios.acceleration * speed, ratios.acceleration * turn_speed),
      longer(of_robot.jerk, ratios.jerk * speed, ratios.jerk * turn_speed)};
}

}  // namespace

RobotModel RobotModelBuilder::on_platform(const RobotModel& robot, double speed,
                                          double turn_speed) {
  RobotModel out = robot;
  double mass = 0;
  for (const Link& link : robot.links()) mass += link.mass;
  const double traction = kTraction * kGravity * mass;
  const char* names[kAdded] = {"platform_x", "platform_y", "platform_heading"};
  std::vector<Link> links(kAdded);
  std::vector<Joint> joints(kAdded);
  for (int i = 0; i < kAdded; ++i) {
    links[static_cast<std::size_t>(i)].name =
        i == 0 ? "world" : std::string(names[i - 1]) + "_carriage";
    links[static_cast<std::size_t>(i)].parent_joint = i - 1;
    Joint& joint = joints[static_cast<std::size_t>(i)];
    const double bound = i < 2 ? kPlatformExtent : kMaxHeading;
    joint.name = names[i];
    joint.kind = i < 2 ? JointKind::prismatic : JointKind::revolute;
    joint.parent = i;
    joint.child = i + 1;
    joint.axis = i == 0 ? Vector3::UnitX() : i == 1 ? Vector3::UnitY() : Vector3::UnitZ();
    joint.dof = robot.dof() + i;
    joint.lower = -bound;
    joint.upper = bound;
    joint.max_velocity = i < 2 ? speed : turn_speed;
    joint.max_effort = i < 2 ? traction : kTractionLever * traction;
  }
  for (Link link : robot.links()) {
    link.parent_joint += kAdded;  // parent of the root, -1, becomes the joint that rotates it
    links.push_back(std::move(link));
  }
  for (Joint joint : robot.joints()) {
    joint.parent += kAdded;
    joint.child += kAdded;
    joints.push_back(std::move(joint));
  }
  out.links_ = std::move(links);
  out.joints_ = std::move(joints);
  for (Axis& axis : out.axes_) axis.joint += kAdded;
  for (int i = 0; i < kAdded; ++i) {
    const Joint& joint = out.joints_[static_cast<std::size_t>(i)];
    out.axes_.push_back({joint.name, i, joint.lower, joint.upper, joint.max_effort});
  }
  for (Group& group : out.groups_)
    if (group.tip >= 0) group.tip += kAdded;
  if (out.tool_ >= 0) out.tool_ += kAdded;
  if (out.gaze_ >= 0) out.gaze_ += kAdded;
  Group platform{kPlatformGroup, {robot.dof(), robot.dof() + 1, robot.dof() + 2}, kAdded},
      whole = platform;
  whole.name = kWholeRobotGroup;
  if (const Group* arm = out.group("arm")) {
    whole.axes.insert(whole.axes.end(), arm->axes.begin(), arm->axes.end());
    whole.tip = arm->tip;
  }
  out.groups_.push_back(platform);
  out.groups_.push_back(whole);
  const auto n = static_cast<int>(out.links_.size());
  out.disabled_pairs_.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), true);
  for (int a = kAdded; a < n; ++a)
    for (int b = kAdded; b < n; ++b)
      out.disabled_pairs_[static_cast<std::size_t>(a) * static_cast<std::size_t>(n) +
                          static_cast<std::size_t>(b)] =
          robot.pair_disabled(a - kAdded, b - kAdded);
  out.comfort_ = longer(robot.comfort_, speed, turn_speed, kComfort);
  out.guard_ = longer(robot.guard_, speed, turn_speed, kGuard);
  out.stop_ = longer(robot.stop_, speed, turn_speed, kGuard);
  out.rest_ = longer(robot.rest_, 0.0, 0.0);
  return out;
}

bool drives(const RobotModel& robot) { return robot.group(kPlatformGroup) != nullptr; }

RobotModel with_platform_axes(const RobotModel& robot, const config::PlatformDescription& platform,
                              const std::filesystem::path& description) {
  const double speed = platform.speed(), turn_speed = platform.turn_speed();
  for (const double value : {speed, turn_speed})
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(description.string() + ": platform.speed and turn_speed must be > 0");
  for (const char* name : {kPlatformGroup, kWholeRobotGroup})
    if (robot.group(name) != nullptr)
      throw ConfigError(description.string() + ": a group is called \"" + name +
                        "\", which a robot with a platform has by itself");
  return RobotModelBuilder::on_platform(robot, speed, turn_speed);
}

std::optional<RobotModel> on_platform(const RobotModel& robot,
                                      const std::filesystem::path& description) {
  if (drives(robot)) return robot;
  const config::RobotDescription text = read_robot_text(description);
  if (!text.has_platform()) return std::nullopt;
  return with_platform_axes(robot, text.platform(), description);
}

Vector with_platform(const Vector& q, const Pose& T_world_base) {
  const Eigen::Matrix3d R = T_world_base.linear();
  Vector out(q.size() + kAdded);
  out << q, T_world_base.translation().head<2>(), std::atan2(R(1, 0), R(0, 0));
  return out;
}

Vector with_platform_at(const RobotModel& robot, const Vector& q, const Vector3& place) {
  return RobotModel::with(q, robot.require_group(kPlatformGroup), place);
}

Vector3 platform_place(const RobotModel& robot, const Vector& q) {
  return RobotModel::part(q, robot.require_group(kPlatformGroup));
}

Pose T_world_platform(const RobotModel& robot, const Vector& q, const Pose& T_world_base) {
  const Group* platform = robot.group(kPlatformGroup);
  return platform == nullptr ? T_world_base : T_world_base * robot.link_pose(q, platform->tip);
}

Pose T_world_platform(const RobotModel& robot, const Scene& scene) {
  return scene.robot_known ? T_world_platform(robot, scene.robot_position, scene.T_world_base)
                           : scene.T_world_base;
}

double nearest_heading(double heading, double near) {
  return near + std::remainder(heading - near, 2 * M_PI);
}

}  // namespace handsel
