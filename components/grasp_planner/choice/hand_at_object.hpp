// SPDX-License-Identifier: Apache-2.0
// The hand in a grasp: supports below it, people beside it, what it hides of the object.
#pragma once

#include <vector>

#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_hand.hpp"
#include "components/grasp_planner/hand/hand_geometry.hpp"
#include "components/grasp_planner/object/graspable.hpp"

namespace handsel::grasp_planner {

/// Returns the body of a person in the frame of an object at `T_world_object`. `digits`: of the
/// hand that holds the object, object frame.
HandShape::PlacedHand body_at_object(const Person& person, const Pose& T_world_object,
                                     const std::vector<HandPart>& digits = {});

/// The body of a person that holds an object, with the digits assumed around the object. Own
/// method.
class HolderBody {
 public:
  /// `person`: world; `digits`: object frame, may be empty. The digits have no clearance yet.
  HolderBody(const Person& person, const Pose& T_world_object, std::vector<HandPart> digits);

  /// Sets the distance that the robot keeps from the digits [m].
  void set_digit_clearance(double clearance);
  /// Returns whether digits are assumed.
  bool has_digits() const { return !digits_.empty(); }
  /// Returns body and digits, larger by their clearances, object frame.
  const HandShape::PlacedHand& placed() const { return placed_; }

 private:
  Person person_;
  Pose T_world_object_;
  std::vector<HandPart> digits_;
  HandShape::PlacedHand placed_;
};

class HandAtObject {
 public:
  /// Keeps references to hand and object. `support_gap`: kept between hand and support [m].
  HandAtObject(const HandGeometry& hand, const Graspable& object, double support_gap);

  /// Returns whether some part of the hand, opened or closed, is in or under a box that supports
  /// the object.
  bool below_support(const std::vector<SceneBox>& boxes, const Pose& T_world_object,
                     const Grasp& g);
  /// Returns whether the object can be stood on a surface in this grasp: the open hand is nowhere
  /// below its foot.
  bool stands_in(const Grasp& g) const;
  /// Returns whether the hand, opened, closed or while it closes, touches a body as of
  /// body_at_object(): for any configuration of the arm.
  /// Adds the tests of a hand to `tests`.
  bool touches(const HandShape::PlacedHand& body, const Grasp& g, std::uint64_t& tests);
  /// Returns the fraction of the object that is seen past the closed hand from an eye, frame of the
  /// object.
  double visible(const Grasp& g, const Vector3& p_object_eye);

 private:
  const HandGeometry& hand_;
  const Graspable& object_;
  double support_gap_;
  std::vector<std::vector<Pose>> T_closed_, T_open_;
};

}  // namespace handsel::grasp_planner
