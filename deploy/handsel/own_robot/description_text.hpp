// SPDX-License-Identifier: Apache-2.0
// The texts that `handsel model new` writes: descriptions of robot and hand, a first scenario.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "deploy/handsel/own_robot/axis_limits.hpp"
#include "deploy/handsel/own_robot/gripper_pads.hpp"
#include "deploy/handsel/own_robot/rest_search.hpp"
#include "deploy/handsel/own_robot/robot_parts.hpp"

namespace handsel {

/// What a description of a robot says.
struct RobotText {
  std::string name, urdf, srdf;              ///< as in RobotDescription; an empty srdf is left out
  std::string hand;                          ///< name or file
  bool mounted{};                            ///< the hand has a URDF of its own, at `flange`
  std::string flange, tool;                  ///< links
  Pose T_flange_palm{Pose::Identity()};      ///< of a mounted hand
  std::vector<std::string> packages;         ///< as in RobotDescription
  std::vector<std::string> without;          ///< as in RobotDescription
  RobotParts parts;                          ///< joints of arm and hand
  std::vector<AxisLimitSet> limits;          ///< of all axes
  std::map<std::string, double> rest;        ///< joint values [rad] or [m]
  std::vector<std::string> notes, only_you;  ///< comments at the top
};

/// Returns the description of a robot as Protobuf text with comments.
std::string text_of(const RobotText& robot);

/// Returns the description of a gripper as Protobuf text. `urdf`: beside the description.
std::string gripper_text(const std::string& name, const std::string& urdf, const Gripper& gripper,
                         const RobotModel& robot);

/// Sizes of a first scenario.
struct FirstScene {
  std::string name, robot;  ///< of scenario and robot
  std::string object;       ///< name of its model
  ArmSize arm;              ///< in the root frame
  double footprint{};  ///< max distance of the links at rest from the root axis, to the right [m]
};

/// Returns a scenario in which the robot takes an object from a table and gives it to a person.
/// An arm whose shoulder is low stands on a stand.
std::string first_scenario(const FirstScene& scene);

/// Returns a pose as Protobuf text: "xyz { x: .. } rpy { x: .. }".
std::string pose_text(const Pose& T);

}  // namespace handsel
