// When the robot's hand holds an object: its measured contacts pass force closure, for a time. Own
// method: the physics has contacts, but no notion of a hold.
#pragma once

#include <vector>

#include "common/grasp/force_closure.hpp"
#include "sim/physics/contacts.hpp"
#include "sim/robot/robot_body.hpp"

namespace handsel::sim {

class RobotGrasp {
 public:
  /// `palm`: link of the hand; -1: there is none.
  RobotGrasp(int palm, const RobotBody&, double touch_force, double grasp_time, double lose_time);

  /// Which chain of the hand a body belongs to: 0 the palm, 1 … the fingers, -1 not the hand.
  int chain_of(int body) const { return body < 0 ? -1 : chain_[body]; }
  int palm() const { return palm_; }  ///< body of the palm; -1: the base, or there is no hand

  /// Normal force with which the hand presses on the object [N].
  double pressure(const std::vector<Touch>&, int object) const;
  /// Net force of the hand's contacts on the object, world [N].
  Vector3 force(const std::vector<Touch>&, int object) const;
  /// Whether the contacts of the hand that bear at least touch_force pass force closure; `centre`:
  /// the object's mass centre, world.
  bool closed(const std::vector<Touch>&, int object, const Vector3& centre);
  /// Call once a step with the object of interest (-1: none); true while it is held.
  bool update(const std::vector<Touch>&, int object, const Vector3& centre, double dt);
  /// Forgets the hold and the times of contact.
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
