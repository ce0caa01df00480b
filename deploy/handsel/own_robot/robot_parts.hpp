// SPDX-License-Identifier: Apache-2.0
// Finds arm, hand and tool link of a robot in its tree of links. Own method: the arm is the longest
// serial chain of axes that turn, the hand is what moves beyond the chain.
#pragma once

#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel {

/// What the tree of links shows of a robot.
struct RobotParts {
  std::vector<std::string> arm;         ///< joints of the arm, from the base to the tool
  int flange{-1};                       ///< link that the hand is attached to, or that is its palm
  std::vector<std::string> hand;        ///< actuated joints beyond the flange; empty: no hand
  std::vector<std::string> held;        ///< actuated joints that are neither arm nor hand
  std::vector<std::string> other_arms;  ///< last joint of each further chain as long as an arm
  std::string redundancy;               ///< joint of the redundancy of an arm of seven axes
};

/// What the user says about the parts.
struct PartWishes {
  std::string tool;  ///< link that carries the hand; empty: searched for
  int min_axes{5};   ///< of an arm
  int max_axes{7};   ///< of an arm: of a longer chain the axes nearest the tool are taken
};

/// Returns the parts of a robot that was loaded by RobotModel::load_urdf. Throws ConfigError when
/// there is no chain of min_axes turning joints, or a joint of arm or hand has no range.
RobotParts find_parts(const RobotModel& robot, const PartWishes& wishes = {});

/// Returns, for each link, whether a link is `top` or descends from `top`.
std::vector<bool> descends_from(const RobotModel& robot, int top);

}  // namespace handsel
