// SPDX-License-Identifier: Apache-2.0
// The hand of a person that holds something.
#pragma once

#include <optional>
#include <vector>

#include "common/messages/side.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_hand.hpp"
#include "common/model/object_model.hpp"

namespace handsel {

/// The same person, the nearer hand of whom holds something at `p_world_object` [m]: its fingers
/// are bent around that instead of stretched out through it, so its capsule ends in the middle of
/// the hand and covers the half of the object that faces the palm. A person without a wrist or a
/// hand joint is returned unchanged. Own method: stretched fingers would reach through the object.
Person with_fingers_bent(const Person&, const Vector3& p_world_object);

/// A hand that holds an object.
struct HoldingHand {
  Side side{};                                                ///< of the person
  Vector3 p_wrist{Vector3::Zero()}, p_hand{Vector3::Zero()};  ///< object frame [m]
  /// Direction in which the palm faces, object frame, not normalised; nullopt: not observed.
  std::optional<Vector3> palm{};
};

/// Returns the hand of a person that is nearer to the surface of the object that the person holds;
/// nullopt: a hand or its wrist is unknown.
std::optional<HoldingHand> holding_hand(const Person&, const ObjectModel&,
                                        const Pose& T_world_object);
/// Moves a hand and its wrist to other positions relative to an object and turns an observed palm;
/// unknown joints and palms stay unknown.
void move_hand(Person&, const HoldingHand&, const Pose& T_world_object);

/// Returns the digits of the nearer hand of a person who holds an object, object frame. Fingers are
/// not observed: they are assumed along the hand, an unobserved palm toward the nearest surface,
/// the digits closed on the object. `turn`: of the hand about its fingers from that pose [rad].
/// Empty: wrist or hand are unknown, or the fingers point at the object. Own method.
std::vector<HandPart> assumed_digits(const Person&, const ObjectModel&, const Pose& T_world_object,
                                     double turn = 0.0);
/// Returns these digits as obstacles without a body around them, world, for each of `turns`, their
/// radii larger by `margin` [m].
OtherRobot digits_as_obstacles(const Person&, const ObjectModel&, const Pose& T_world_object,
                               double margin, const std::vector<double>& turns);

}  // namespace handsel
