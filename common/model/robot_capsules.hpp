// The robot as a few capsules (one a shape, more for flat boxes), covering its collision shapes: the fast form for separation and costs.
#pragma once

#include <vector>

#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

struct LinkCapsule {
  int link{};
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< link frame [m]
  double radius{};
};

/// Fitted so that every vertex of the link's collision shapes is inside.
std::vector<LinkCapsule> robot_capsules(const RobotModel&);

/// Nearest approach of robot and person.
struct Separation {
  double distance{};  ///< [m], may be negative when overlapping; +inf if nobody
  int link{-1};
  BodyPart part{};
  std::string person;
  Vector3 on_robot{Vector3::Zero()}, on_person{Vector3::Zero()};  ///< world
};

/// Exchanging forearm and hand excepted from separation (formulas: section 4).
struct Exception {
  std::string person;  ///< empty: none
  Side side{Side::right};
  bool both_sides{true};  ///< when the taking hand is not known yet
};

/// T_root_link from RobotModel::forward. Allocates nothing (person ids up to 15 characters, complete bodies).
Separation separation(const std::vector<LinkCapsule>& robot, const std::vector<Pose>& T_root_link, const Pose& T_world_base,
                      const HumanState& people, const Exception& exception = {});

}  // namespace handsel
