// SPDX-License-Identifier: Apache-2.0
// Contacts between bodies, read from Bullet after a step.
#pragma once

#include <vector>

#include "sim/physics/bullet.hpp"

namespace handsel::sim {

/// The owner of a collision object; stored in the object's user indices together with a number.
enum class Owner : int { robot = 1, object = 2, fixed = 3, floor = 4, person = 5 };

/// Collision groups of Bullet's filter.
enum CollisionGroup : int { kRobot = 64, kObject = 128, kFixed = 256, kPerson = 512 };

/// Marks a collision object with its owner and its number among the owner's bodies, as gather()
/// reads them.
inline void own(btCollisionObject& object, Owner owner, int index) {
  object.setUserIndex(static_cast<int>(owner));
  object.setUserIndex2(index);
}

/// One contact point. `a` is the robot if it takes part, else the object.
struct Touch {
  Owner a{}, b{};                       ///< the two parties
  int index_a{}, index_b{};             ///< numbers given to own()
  Vector3 point{Vector3::Zero()};       ///< world [m]
  Vector3 normal{Vector3::UnitZ()};     ///< contact normal from b to a, world
  double distance{};                    ///< [m]; negative: overlap
  double normal_force{};                ///< magnitude [N]
  Vector3 force_on_a{Vector3::Zero()};  ///< with friction, world [N]
  double friction{};                    ///< Coulomb coefficient of the pair
  double torsion{};                     ///< max torque about the normal per normal force [m]
};

/// Replaces `out` by the contacts closer than `reach` of the last step of length dt.
void gather(btDispatcher&, double dt, double reach, std::vector<Touch>& out);

}  // namespace handsel::sim
