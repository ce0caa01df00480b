// SPDX-License-Identifier: Apache-2.0
// Finds the pads of a gripper of two fingers in its collision shapes. Own method: the faces toward
// each other of the two bodies that reach farthest and approach each other when the joints move.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"
#include "deploy/handsel/own_robot/robot_parts.hpp"

namespace handsel {

/// One finger of a gripper.
struct GripperFinger {
  std::string link;                   ///< that has the pad
  std::vector<std::string> joints;    ///< actuated joints that move it, from the palm outward
  Pose T_link_pad{Pose::Identity()};  ///< middle of the pad; z is the direction of pressing
  double width{}, height{};           ///< of the pad along x and y [m]
};

/// A gripper of two fingers with pads.
struct Gripper {
  std::array<GripperFinger, 2> fingers;  ///< a pad each, facing each other
  std::map<std::string, double> open;    ///< joint values with the largest gap [rad] or [m]
  std::map<std::string, double> closed;  ///< joint values with the smallest gap [rad] or [m]
  Pose T_palm_grasp{Pose::Identity()};   ///< between the pads, half open, axes of the palm
  Vector3 reach{Vector3::UnitZ()};       ///< direction from the palm to the pads, palm frame, unit
  double max_gap{};                      ///< between the pads when open [m]
};

/// Bounds of the search.
struct PadSettings {
  double finger_reach{0.8};   ///< of the reach of the farthest finger, that makes a body a finger
  double face_depth{0.0015};  ///< depth of the surface that counts as the face of a pad [m]
  double min_side{0.006};     ///< of a pad [m]
  double max_side{0.05};      ///< of a pad [m]
  double fill{0.9};           ///< of the sides of the face that the pad covers
};

/// Returns the gripper below parts.flange of a robot loaded by RobotModel::load_urdf. Throws
/// ConfigError with one sentence when there are not two fingers, or they do not approach each
/// other.
Gripper find_gripper(const RobotModel& robot, const RobotParts& parts,
                     const PadSettings& settings = {});

/// Returns the corner points of a shape, in its frame [m]: all vertices of a mesh, points on the
/// rims of round shapes.
std::vector<Vector3> corners_of(const Shape& shape);

}  // namespace handsel
