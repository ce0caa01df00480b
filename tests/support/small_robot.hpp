// SPDX-License-Identifier: Apache-2.0
// A small robot for tests: arm of three axes, hand of two, pan-tilt head; written to a temporary
// folder and loaded like any other.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "common/model/robot_model.hpp"

namespace handsel::test {

inline std::string small_urdf_link(const std::string& name, const std::string& geometry,
                                   const std::string& origin) {
  return "<link name='" + name +
         "'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' "
         "iyz='0'/></inertial>" +
         (geometry.empty() ? ""
                           : "<collision><origin xyz='" + origin + "'/><geometry>" + geometry +
                                 "</geometry></collision>") +
         "</link>\n";
}

inline std::string small_urdf_joint(const std::string& name, const std::string& parent,
                                    const std::string& child, const std::string& xyz,
                                    const std::string& axis, double lower, double upper) {
  return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='" + xyz + "'/><axis xyz='" + axis + "'/><limit lower='" +
         std::to_string(lower) + "' upper='" + std::to_string(upper) +
         "' velocity='3' effort='100'/></joint>\n";
}

/// Base at the origin, shoulder 1 m high; at zero the arm reaches 0.8 m along +x. Camera at (0,
/// 0, 1.3) looking along +x.
inline std::shared_ptr<const RobotModel> small_robot() {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                       ("handsel_small_robot_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "small.urdf")
      << "<robot name='small'>\n"
      << small_urdf_link("base", "<box size='0.3 0.3 0.8'/>", "0 0 0.4")
      << small_urdf_link("turn", "", "")
      << small_urdf_link("upper", "<box size='0.36 0.08 0.08'/>", "0.2 0 0")
      << small_urdf_link("lower", "<box size='0.36 0.08 0.08'/>", "0.2 0 0")
      << small_urdf_link("finger_a", "<box size='0.06 0.02 0.02'/>", "0.03 0 0")
      << small_urdf_link("finger_b", "<box size='0.06 0.02 0.02'/>", "0.03 0 0")
      << small_urdf_link("pan_link", "", "") << small_urdf_link("camera", "", "")
      << small_urdf_joint("shoulder_turn", "base", "turn", "0 0 1", "0 0 1", -2.9, 2.9)
      << small_urdf_joint("shoulder", "turn", "upper", "0 0 0", "0 1 0", -2, 2)
      << small_urdf_joint("elbow", "upper", "lower", "0.4 0 0", "0 1 0", -2.5, 2.5)
      << small_urdf_joint("finger_a_joint", "lower", "finger_a", "0.4 0.04 0", "0 0 1", -0.2, 1.4)
      << small_urdf_joint("finger_b_joint", "lower", "finger_b", "0.4 -0.04 0", "0 0 -1", -0.2, 1.4)
      << small_urdf_joint("pan", "base", "pan_link", "0 0 1.3", "0 0 1", -2.9, 2.9)
      << small_urdf_joint("tilt", "pan_link", "camera", "0 0 0", "0 -1 0", -0.7, 0.5)
      << "</robot>\n";
  std::ofstream(folder / "small.srdf") << "<robot name='small'/>\n";
  const auto limits = [](const char* kind, double arm, double hand) {
    const auto one = [&](const char* joints, double v, double a, double j) {
      return std::string(kind) + " { " + joints + " velocity: " + std::to_string(v) +
             " acceleration: " + std::to_string(a) + " jerk: " + std::to_string(j) + " }\n";
    };
    return one("joints: \"shoulder_turn\" joints: \"shoulder\" joints: \"elbow\"", 0.5 * arm,
               1.0 * arm, 3.0 * arm) +
           one("joints: \"finger_a_joint\" joints: \"finger_b_joint\" joints: \"pan\" joints: "
               "\"tilt\"",
               2.5 * hand, 12 * hand, 90 * hand);
  };
  std::ofstream(folder / "small.txtpb")
      << "name: \"small\" urdf: \"small.urdf\" srdf: \"small.srdf\"\n"
      << "groups { name: \"arm\" joints: \"shoulder_turn\" joints: \"shoulder\" joints: \"elbow\" "
         "tip_link: \"lower\" }\n"
      << "groups { name: \"hand\" joints: \"finger_a_joint\" joints: \"finger_b_joint\" }\n"
      << "groups { name: \"head\" joints: \"pan\" joints: \"tilt\" tip_link: \"camera\" }\n"
      << "tool_link: \"lower\" gaze_link: \"camera\"\n"
      << limits("comfort", 1.0, 1.0) << limits("guard", 1.12, 1.12) << limits("stop", 1.12, 1.12);
  return std::make_shared<const RobotModel>(RobotModel::load(folder / "small.txtpb"));
}

}  // namespace handsel::test
