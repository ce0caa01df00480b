// SPDX-License-Identifier: Apache-2.0
// Makes the description of a user's robot from its URDF: parts, limits, collision matrix, rest
// configuration, hand, first scenario and picture.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "deploy/handsel/own_robot/axis_limits.hpp"
#include "deploy/handsel/own_robot/collision_matrix.hpp"
#include "deploy/handsel/own_robot/robot_parts.hpp"

namespace handsel {

/// What the user wants, and where it is written.
struct RobotWishes {
  std::filesystem::path urdf;          ///< of the user, no xacro
  std::filesystem::path srdf;          ///< of MoveIt; empty: none
  std::filesystem::path joint_limits;  ///< of MoveIt; empty: none
  std::string name;                    ///< of the robot
  std::string hand;                    ///< hand description; empty: the URDF's, else parallel
  std::string tool;                    ///< link that carries the hand; empty: searched for
  std::vector<std::string> without;    ///< links left out, with all they carry
  std::vector<std::filesystem::path> packages;  ///< further folders of package://
  std::filesystem::path folder;                 ///< is made
  MatrixSettings matrix;                        ///< of the sampling
};

/// What was made.
struct MadeRobot {
  std::filesystem::path description;         ///< of the robot
  std::filesystem::path scenario;            ///< a first give
  std::vector<std::filesystem::path> files;  ///< all, the description first
  std::vector<std::string> notes;            ///< what was corrected or assumed
  std::vector<std::string> only_you;         ///< what only the user can know
  RobotParts parts;                          ///< of the URDF
  std::vector<LinkPair> pairs;               ///< sampled
  int capsules{};                            ///< around the links
  double reach{};                            ///< from the shoulder to the grasp frame [m]
};

/// Describes what is done, with the fraction of it; returns false when the time is over.
using MakerProgress = std::function<bool(const std::string& what, double done)>;

/// Makes and writes the robot. Throws ConfigError or MissingError with one sentence; then the
/// folder holds no description.
MadeRobot make_robot(const RobotWishes& wishes, const MakerProgress& progress);

}  // namespace handsel
