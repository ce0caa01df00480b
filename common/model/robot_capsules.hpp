// SPDX-License-Identifier: Apache-2.0
// The robot as a few capsules (one a shape, more for flat boxes), covering its collision shapes:
// the fast form for separation and costs.
#pragma once

#include <vector>

#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

struct LinkCapsule {
  int link{};                                      ///< index into RobotModel::links()
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the axis, link frame [m]
  double radius{};                                 ///< [m]
};

/// Returns the capsules of all links, fitted so that every vertex of the link's collision shapes is
/// inside.
std::vector<LinkCapsule> robot_capsules(const RobotModel&);

/// Nearest approach of robot and person.
struct Separation {
  double distance{};   ///< [m], may be negative when overlapping; +inf without people
  int link{-1};        ///< of the robot; -1 without people
  BodyPart part{};     ///< of that person
  std::string person;  ///< id; empty without people
  Vector3 on_robot{Vector3::Zero()}, on_person{Vector3::Zero()};  ///< world [m]
};

/// Forearm and hand of the handover, exempt from separation (formulas: section 4).
struct SeparationExemption {
  std::string person;      ///< empty: none
  Side side{Side::right};  ///< of the taking hand, unless both_sides
  bool both_sides{true};   ///< when the taking hand is not known yet
};

/// Returns the nearest approach; T_root_link from RobotModel::forward. Allocates nothing (person
/// ids up to 15 characters, complete bodies).
Separation separation(const std::vector<LinkCapsule>& robot, const std::vector<Pose>& T_root_link,
                      const Pose& T_world_base, const HumanState& people,
                      const SeparationExemption& exception = {});

}  // namespace handsel
