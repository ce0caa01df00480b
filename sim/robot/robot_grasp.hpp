// SPDX-License-Identifier: Apache-2.0
// Decides when the robot's hand holds an object: its contacts have force closure for a time. Own
// method: the physics engine has contacts, but no grasps.
#pragma once

#include <vector>

#include "common/grasp/force_closure.hpp"
#include "sim/physics/contacts.hpp"
#include "sim/robot/robot_body.hpp"

namespace handsel::sim {

class RobotGrasp {
 public:
  /// `palm`: link of the palm; -1: the robot has no hand. `touch_force`: min normal force of a
  /// contact [N]; `grasp_time`, `lose_time`: time with or without force closure that begins or ends
  /// a grasp [s].
  RobotGrasp(int palm, const RobotBody&, double touch_force, double grasp_time, double lose_time);

  /// Returns the chain of the hand to which a body belongs: 0 palm, from 1 fingers, -1 not the
  /// hand.
  int chain_of(int body) const { return body < 0 ? -1 : chain_[body]; }
  int palm() const { return palm_; }  ///< body of the palm; -1: the base, or no hand

  /// Returns the hand's total normal force on the object [N].
  double pressure(const std::vector<Touch>&, int object) const;
  /// Returns the net force of the hand's contacts on the object, world [N].
  Vector3 force(const std::vector<Touch>&, int object) const;
  /// Returns whether the hand's contacts of at least touch_force have force closure; `centre`: the
  /// object's centre of mass, world.
  bool closed(const std::vector<Touch>&, int object, const Vector3& centre);
  /// Evaluates one step for an object (-1: none); returns whether the hand holds the object.
  bool update(const std::vector<Touch>&, int object, const Vector3& centre, double dt);
  /// Resets the grasp and the times of contact.
  void reset() { closed_for_ = open_for_ = 0, held_ = false; }

 private:
  bool of_hand(const Touch& t, int object) const {
    return t.a == Owner::robot && t.b == Owner::object && t.index_b == object &&
           chain_of(t.index_a) >= 0;
  }

  double touch_force_, grasp_time_, lose_time_, closed_for_{0}, open_for_{0};
  bool held_{false};
  int palm_{-1};
  std::vector<int> chain_;
  std::vector<PointContact> contacts_;
};

}  // namespace handsel::sim
