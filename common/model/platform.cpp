#include "common/model/platform.hpp"

#include <cmath>

#include "common/config/resources.hpp"
#include "common/model/description/robot_model_builder.hpp"

namespace handsel {
namespace {

constexpr int kAdded = 3;              // axes, joints and links
constexpr double kMostHeading = 40.0;  // [rad]
constexpr double kGuardMargin = 1.1;

Vector longer(const Vector& of_robot, double linear, double angular) {
  Vector out(of_robot.size() + kAdded);
  out << of_robot, linear, linear, angular;
  return out;
}

KinematicLimits longer(const KinematicLimits& of_robot, double speed, double turn_speed) {
  return {longer(of_robot.velocity, speed, turn_speed),
          longer(of_robot.acceleration, 2 * speed, 2 * turn_speed),
          longer(of_robot.jerk, 6 * speed, 6 * turn_speed)};
}

}  // namespace

RobotModel RobotModelBuilder::on_platform(const RobotModel& robot, double speed,
                                          double turn_speed) {
  RobotModel out = robot;
  const char* names[kAdded] = {"platform_x", "platform_y", "platform_heading"};
  std::vector<Link> links(kAdded);
  std::vector<Joint> joints(kAdded);
  for (int i = 0; i < kAdded; ++i) {
    links[static_cast<std::size_t>(i)].name =
        i == 0 ? "world" : std::string(names[i - 1]) + "_carriage";
    links[static_cast<std::size_t>(i)].parent_joint = i - 1;
    Joint& joint = joints[static_cast<std::size_t>(i)];
    const double most = i < 2 ? kPlatformExtent : kMostHeading;
    joint.name = names[i];
    joint.kind = i < 2 ? JointKind::prismatic : JointKind::revolute;
    joint.parent = i;
    joint.child = i + 1;
    joint.axis = i == 0 ? Vector3::UnitX() : i == 1 ? Vector3::UnitY() : Vector3::UnitZ();
    joint.dof = robot.dof() + i;
    joint.lower = -most;
    joint.upper = most;
    joint.max_velocity = i < 2 ? speed : turn_speed;
  }
  for (Link link : robot.links()) {
    link.parent_joint += kAdded;  // of the root, -1, to the joint that turns it
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
    out.axes_.push_back({joint.name, i, joint.lower, joint.upper, 0.0});
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
  out.comfort_ = longer(robot.comfort_, speed, turn_speed);
  out.guard_ = longer(robot.guard_, kGuardMargin * speed, kGuardMargin * turn_speed);
  out.stop_ = longer(robot.stop_, kGuardMargin * speed, kGuardMargin * turn_speed);
  out.rest_ = longer(robot.rest_, 0.0, 0.0);
  return out;
}

std::optional<RobotModel> on_platform(const RobotModel& robot,
                                      const std::filesystem::path& description) {
  config::RobotDescription text;
  load_text_proto(description, text);
  if (!text.has_platform()) return std::nullopt;
  const double speed = text.platform().speed(), turn_speed = text.platform().turn_speed();
  for (const double value : {speed, turn_speed})
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(description.string() + ": platform.speed and turn_speed must be > 0");
  for (const char* name : {kPlatformGroup, kWholeRobotGroup})
    if (robot.group(name) != nullptr)
      throw ConfigError(description.string() + ": a group is called \"" + name +
                        "\", which a robot with a platform has by itself");
  return RobotModelBuilder::on_platform(robot, speed, turn_speed);
}

Vector with_platform(const Vector& q, const Pose& T_world_base) {
  const Eigen::Matrix3d R = T_world_base.linear();
  Vector out(q.size() + kAdded);
  out << q, T_world_base.translation().head<2>(), std::atan2(R(1, 0), R(0, 0));
  return out;
}

double nearest_heading(double heading, double near) {
  return near + std::remainder(heading - near, 2 * M_PI);
}

}  // namespace handsel
