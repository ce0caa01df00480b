// SPDX-License-Identifier: Apache-2.0
// URDFs of robots from published dimensions, masses and limits, with primitive shapes: what a user
// brings, without a maker's file.
#pragma once

#include <string>

namespace handsel::test {

/// Shape of a link: an element of <geometry>, with its origin in the link's frame.
struct UrdfShape {
  std::string geometry{}, xyz{"0 0 0"}, rpy{"0 0 0"};
};

inline std::string cylinder(double radius, double length) {
  return "<cylinder radius=\"" + std::to_string(radius) + "\" length=\"" + std::to_string(length) +
         "\"/>";
}

inline std::string box(const std::string& size) { return "<box size=\"" + size + "\"/>"; }

/// Returns a link with one shape; mass 0: without inertia.
inline std::string urdf_link(const std::string& name, double mass, const UrdfShape& shape) {
  const std::string inertia = std::to_string(0.0015 * mass + 1e-5);
  std::string text = "<link name=\"" + name + "\">\n";
  if (mass > 0)
    text += "<inertial><mass value=\"" + std::to_string(mass) + "\"/><inertia ixx=\"" + inertia +
            "\" iyy=\"" + inertia + "\" izz=\"" + inertia +
            "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\n";
  if (!shape.geometry.empty())
    text += "<collision><origin xyz=\"" + shape.xyz + "\" rpy=\"" + shape.rpy + "\"/><geometry>" +
            shape.geometry + "</geometry></collision>\n";
  return text + "</link>\n";
}

/// What moves in a joint.
struct UrdfMotion {
  std::string type{"fixed"}, axis{"0 0 1"};
  double lower{}, upper{}, velocity{}, effort{};
  std::string mimics{};  ///< joint that is followed; empty: none
  double multiplier{1};  ///< of the joint that is followed
};

/// Returns a joint from `parent` to `child` at an origin "x y z" and "r p y".
inline std::string urdf_joint(const std::string& name, const std::string& parent,
                              const std::string& child, const UrdfShape& origin,
                              const UrdfMotion& m = {}) {
  std::string text = "<joint name=\"" + name + "\" type=\"" + m.type + "\">\n<parent link=\"" +
                     parent + "\"/><child link=\"" + child + "\"/>\n<origin xyz=\"" + origin.xyz +
                     "\" rpy=\"" + origin.rpy + "\"/>\n";
  if (m.type != "fixed")
    text += "<axis xyz=\"" + m.axis + "\"/>\n<limit lower=\"" + std::to_string(m.lower) +
            "\" upper=\"" + std::to_string(m.upper) + "\" velocity=\"" +
            std::to_string(m.velocity) + "\" effort=\"" + std::to_string(m.effort) + "\"/>\n";
  if (!m.mimics.empty())
    text += "<mimic joint=\"" + m.mimics + "\" multiplier=\"" + std::to_string(m.multiplier) +
            "\" offset=\"0\"/>\n";
  return text + "</joint>\n";
}

/// Returns the links and joints of a Universal Robots UR5e, from base_link to tool0.
inline std::string ur5e() {
  const std::string quarter = "1.57079633", along_x = "0 1.57079633 0";
  const UrdfMotion large{"revolute", "0 0 1", -6.2831853, 6.2831853, 3.14159, 150},
      elbow{"revolute", "0 0 1", -3.14159, 3.14159, 3.14159, 150},
      wrist{"revolute", "0 0 1", -6.2831853, 6.2831853, 3.14159, 28};
  return urdf_link("base_link", 4, {cylinder(0.075, 0.09), "0 0 0.045"}) +
         urdf_joint("shoulder_pan_joint", "base_link", "shoulder_link", {"", "0 0 0.1625"}, large) +
         urdf_link("shoulder_link", 3.761, {cylinder(0.06, 0.14), "0 0 -0.005"}) +
         urdf_joint("shoulder_lift_joint", "shoulder_link", "upper_arm_link",
                    {"", "0 0 0", quarter + " 0 0"}, large) +
         urdf_link("upper_arm_link", 8.058, {cylinder(0.055, 0.425), "-0.2125 0 0.138", along_x}) +
         urdf_joint("elbow_joint", "upper_arm_link", "forearm_link", {"", "-0.425 0 0"}, elbow) +
         urdf_link("forearm_link", 2.846, {cylinder(0.045, 0.33), "-0.2 0 0.007", along_x}) +
         urdf_joint("wrist_1_joint", "forearm_link", "wrist_1_link", {"", "-0.3922 0 0.1333"},
                    wrist) +
         urdf_link("wrist_1_link", 1.37, {cylinder(0.04, 0.11), "0 0 -0.06"}) +
         urdf_joint("wrist_2_joint", "wrist_1_link", "wrist_2_link",
                    {"", "0 -0.0997 0", quarter + " 0 0"}, wrist) +
         urdf_link("wrist_2_link", 1.3, {cylinder(0.04, 0.1), "0 0 -0.03"}) +
         urdf_joint("wrist_3_joint", "wrist_2_link", "wrist_3_link",
                    {"", "0 0.0996 0", quarter + " 3.14159265 3.14159265"}, wrist) +
         urdf_link("wrist_3_link", 0.365, {cylinder(0.037, 0.04), "0 0 -0.022"}) +
         urdf_joint("tool0_fixed", "wrist_3_link", "tool0", {}) + urdf_link("tool0", 0, {});
}

/// Returns the links and joints of a Robotiq 2F-85 on a link: one motor, five joints that mimic it.
inline std::string robotiq_2f85(const std::string& parent) {
  std::string text = urdf_joint("robotiq_base_joint", parent, "robotiq_base", {}) +
                     urdf_link("robotiq_base", 0.9, {box("0.07 0.12 0.09"), "0 0 0.045"});
  for (const std::string side : {"left", "right"}) {
    const bool left = side == "left";
    const std::string sign = left ? "-" : "", turned = left ? "0 0 3.14159265" : "0 0 0";
    const UrdfMotion driver{"revolute", "1 0 0", 0, 0.8, 2, 1000, left ? "" : "finger_joint", 1},
        same{"revolute", "1 0 0", 0, 0.8, 2, 1000, "finger_joint", 1},
        opposite{"revolute", "1 0 0", -0.88, 0.81, 2, 1000, "finger_joint", -1};
    text += urdf_joint(left ? "finger_joint" : "right_outer_knuckle_joint", "robotiq_base",
                       side + "_outer_knuckle", {"", "0 " + sign + "0.0306011 0.054904", turned},
                       driver) +
            urdf_link(side + "_outer_knuckle", 0.009, {box("0.02 0.03 0.01"), "0 0.0158 0"}) +
            urdf_joint(side + "_outer_finger_joint", side + "_outer_knuckle",
                       side + "_outer_finger", {"", "0 0.0315 -0.0041"}) +
            urdf_link(side + "_outer_finger", 0.02, {box("0.02 0.012 0.047"), "0 0.003 0.0235"}) +
            urdf_joint(side + "_inner_knuckle_joint", "robotiq_base", side + "_inner_knuckle",
                       {"", "0 " + sign + "0.0127 0.06142", turned}, same) +
            urdf_link(side + "_inner_knuckle", 0.03,
                      {box("0.02 0.012 0.04"), "0 0.018 0.02", "0.5 0 0"}) +
            urdf_joint(side + "_inner_finger_joint", side + "_outer_finger", side + "_inner_finger",
                       {"", "0 0.0061 0.0471"}, opposite) +
            urdf_link(side + "_inner_finger", 0.01, {box("0.02 0.012 0.045"), "0 -0.012 0.0275"}) +
            urdf_joint(side + "_pad_joint", side + "_inner_finger", side + "_inner_finger_pad",
                       {"", "0 -0.0220203 0.03242"}) +
            urdf_link(side + "_inner_finger_pad", 0.005, {box("0.022 0.00635 0.0375")});
  }
  return text;
}

/// Returns a URDF of links and joints.
inline std::string urdf(const std::string& name, const std::string& parts) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"" + name + "\">\n" + parts + "</robot>\n";
}

}  // namespace handsel::test
