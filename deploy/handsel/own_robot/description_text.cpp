// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/description_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel {
namespace {

/// Returns a number with up to six digits; at most the value when `down`.
std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::abs(value) < 1e-9 ? 0.0 : value);
  return text;
}

std::string quoted_list(const std::vector<std::string>& names) {
  std::string text = "[";
  for (std::size_t i = 0; i < names.size(); ++i) text += (i ? ", \"" : "\"") + names[i] + "\"";
  return text + "]";
}

std::string limit_line(const std::string& field, const std::string& joint, double v, double a,
                       double j) {
  return field + " { joints: \"" + joint + "\" velocity: " + number_text(v) +
         " acceleration: " + number_text(a) + " jerk: " + number_text(j) + " }";
}

std::string comments(const std::string& head, const std::vector<std::string>& lines) {
  std::string text;
  if (!lines.empty()) text = "#\n# " + head + "\n";
  for (const std::string& line : lines) text += "# - " + line + "\n";
  return text;
}

std::string xyz(double x, double y, double z) {
  return "x: " + number_text(x) + " y: " + number_text(y) + " z: " + number_text(z);
}

}  // namespace

std::string pose_text(const Pose& T) {
  const Eigen::Matrix3d R = T.linear();
  const Vector3 p = T.translation();
  const double pitch = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  constexpr double kVertical = 1 - 1e-9;  // sine of a pitch at which roll and yaw are one angle
  const bool vertical = std::abs(R(2, 0)) > kVertical;
  const Vector3 rpy(vertical ? 0.0 : std::atan2(R(2, 1), R(2, 2)), pitch,
                    vertical ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0)));
  return "xyz { " + xyz(p.x(), p.y(), p.z()) + " } rpy { " + xyz(rpy.x(), rpy.y(), rpy.z()) + " }";
}

std::string text_of(const RobotText& robot) {
  std::string text = "# " + robot.name + ", written by `handsel model new`; edit as you like.\n";
  text += comments("Corrected or assumed:", robot.notes);
  text += comments("Only you can know:", robot.only_you);
  text += "name: \"" + robot.name + "\"\nurdf: \"" + robot.urdf + "\"\n";
  if (!robot.srdf.empty()) text += "srdf: \"" + robot.srdf + "\"\n";
  for (const std::string& folder : robot.packages) text += "packages: \"" + folder + "\"\n";
  if (!robot.without.empty()) text += "without: " + quoted_list(robot.without) + "\n";
  text += "\nhand: \"" + robot.hand + "\"\n";
  if (robot.mounted)
    text +=
        "# The palm on the flange: z along the last axis, beyond the shapes of the arm.\n"
        "mount { link: \"" +
        robot.flange + "\" pose { " + pose_text(robot.T_flange_palm) + " } }\n";
  text += "\n# The axes, in the order of every message.\ngroups {\n  name: \"arm\"\n  joints: " +
          quoted_list(robot.parts.arm) + "\n  tip_link: \"" + robot.tool +
          "\"\n}\ngroups { name: \"hand\" joints: " + quoted_list(robot.parts.hand) + " }\n" +
          "tool_link: \"" + robot.tool + "\"\n";
  if (!robot.parts.redundancy.empty())
    text += "redundancy_joint: \"" + robot.parts.redundancy + "\"\n";
  text += "\n# Planning: speeds people find comfortable, at most guard / 1.1.\n";
  for (const AxisLimitSet& l : robot.limits)
    text +=
        limit_line("comfort", l.joint, l.comfort_velocity, l.comfort_acceleration, l.comfort_jerk) +
        "\n";
  for (const char* field : {"guard", "stop"}) {
    text += field == std::string("guard") ? "\n# Never exceeded by any set-point.\n"
                                          : "\n# Stopping and recoil use all the guard allows.\n";
    for (const AxisLimitSet& l : robot.limits)
      text += "# " + l.source + "\n" +
              limit_line(field, l.joint, l.velocity, l.acceleration, l.jerk) + "\n";
  }
  text += "\n# The hand before the base, fingers down; joints outside the groups are held here.\n";
  for (const auto& [joint, value] : robot.rest)
    text += "rest { key: \"" + joint + "\" value: " + number_text(value) + " }\n";
  return text;
}

std::string gripper_text(const std::string& name, const std::string& urdf, const Gripper& gripper,
                         const RobotModel& robot) {
  constexpr double kOpen = 0.97;      // of the way from closed to open, before a grasp
  constexpr double kMargin = 0.0125;  // of the smallest range, not used for contacts
  std::string text = "# " + name +
                     ", written by `handsel model new`: check pads, grasp_frame and grip_force.\n"
                     "name: \"" +
                     name + "\"\nurdf: \"" + urdf + "\"\n";
  char gap[64];
  std::snprintf(gap, sizeof gap, "%.1f", 1e3 * gripper.max_gap);
  text += "# Pads: z presses; they open to " + std::string(gap) + " mm.\n";
  for (std::size_t f = 0; f < 2; ++f) {
    const GripperFinger& finger = gripper.fingers[f];
    text += "fingers {\n  name: \"finger_" + std::to_string(f + 1) +
            "\" joints: " + quoted_list(finger.joints) + " tip_link: \"" + finger.link +
            "\"\n  pad { pose { " + pose_text(finger.T_link_pad) +
            " } width: " + number_text(finger.width) + " height: " + number_text(finger.height) +
            " }\n}\n";
  }
  text +=
      "# Between the pads, half open.\ngrasp_frame { " + pose_text(gripper.T_palm_grasp) + " }\n";
  double range = 1e9, effort = 0;
  for (const auto& [joint, open] : gripper.open) {
    const double closed = gripper.closed.at(joint);
    range = std::min(range, std::abs(open - closed));
    for (const Axis& axis : robot.axes())
      if (axis.name == joint) effort = std::max(effort, axis.max_effort);
    text += "rest { key: \"" + joint + "\" value: " + number_text((open + closed) / 2) + " }\n";
    text += "pregrasp { key: \"" + joint +
            "\" value: " + number_text(closed + kOpen * (open - closed)) + " }\n";
  }
  constexpr double kMaxEffort = 1000;  // of the schema
  text += "contact_margin: " + number_text(kMargin * range) +
          "\nmax_effort: " + number_text(std::min(effort, kMaxEffort)) +
          "\n# Assumed: a grip for objects of up to half a kilogram [N].\ngrip_force: 30\n";
  return text;
}

std::string first_scenario(const FirstScene& scene) {
  constexpr double kLowShoulder = 0.5, kStand = 0.72;  // [m]
  constexpr double kReach = 0.95;                      // of the arm whose scene is scaled [m]
  const bool stands = scene.arm.shoulder.z() < kLowShoulder;
  const double s = std::clamp(scene.arm.reach / kReach, 0.7, 1.15), x = scene.arm.shoulder.x();
  const double edge = std::min(-0.27, -scene.footprint - 0.03);  // of the table, to the right [m]
  const double y = std::min(-0.42 * s, edge - 0.13);
  std::string text = "# " + scene.robot +
                     " takes an object from the table at its right and gives it to a person before "
                     "it. Written by `handsel model new`.\nname: \"" +
                     scene.name + "\"\nrobot: \"" + scene.robot + "\"\n";
  if (stands)
    text += "base { xyz { z: " + number_text(kStand) +
            " } }\nboxes { id: \"stand\" pose { xyz { z: 0.34 } } size { x: 0.24 y: 0.24 z: 0.68 } "
            "}\n";
  text += "boxes {\n  id: \"table\"\n  pose { xyz { " + xyz(x + 0.40 * s, edge - 0.35, 0.36) +
          " } }\n  size { x: 0.7 y: 0.7 z: 0.72 }\n  supports: true\n}\n";
  text += "objects { id: \"thing\" model: \"" + scene.object +
          "\" on: \"table\" pose { xyz { x: " + number_text(x + 0.38 * s) +
          " y: " + number_text(y) + " } } jitter: 0.03 }\n";
  text += "people { id: \"anna\" x: " + number_text(x + 0.2 + 0.98 * s) +
          " y: 0.05 yaw: 3.1416 stature: 1.72 behaviour: TAKER jitter: 0.05 }\n"
          "human_sensors { source: \"kinect\" rate: 30 latency: 0.04 noise: 0.004 }\n"
          "object_sensors { source: \"object_tracker\" rate: 30 latency: 0.04 noise: 0.001 }\n"
          "tasks { kind: \"give\" object: \"thing\" human: \"anna\" }\ntimeout: 90\n";
  return text;
}

}  // namespace handsel
