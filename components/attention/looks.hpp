// SPDX-License-Identifier: Apache-2.0
// Observations common to several behaviours.
#pragma once

#include <limits>
#include <string>

#include "components/attention/schema.hpp"

namespace handsel::attention {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Returns whether the positions of all axes of the robot are known.
bool robot_known(const World& w, const Body& body);
/// Returns whether an action of this kind is running.
bool doing(const World& w, ActionKind kind);
/// Returns the person of interest: the partner of the action if observed, else the person whose
/// torso is nearest to `p`; null: none.
const Person* person_of_interest(const World& w, const Vector3& p, double lost_after);
/// Returns whether a fact of this kind holds about the person; empty id: about any person.
bool holds(const World& w, FactKind kind, const std::string& person);
/// Returns whether the person attends to the robot; true without facts.
bool attentive(const World& w, const std::string& person);

/// The hand of a person that is nearest to a point.
struct NearHand {
  double distance{kInfinity};                                    ///< distance from the point [m]
  Vector3 position{Vector3::Zero()}, velocity{Vector3::Zero()};  ///< of the hand, world [m], [m/s]
};
/// Returns the hand of the person that is nearest to `p` (world [m]). The person needs all joints.
NearHand nearest_hand(const Person& person, const Vector3& p);

/// Returns the shift of a give's exchange point that brings the object to the person's extended
/// hand, world [m]: the offset of this hand's wrist from the planned wrist, or, without a planned
/// wrist, of the hand from a point beyond the exchange point. nullopt: no extended hand, or not the
/// planned one. `p_robot`: position of the robot, world [m].
std::optional<Vector3> shift_to_extended_hand(const ActionStatus& action, const Person& person,
                                              const Vector3& p_robot, const MotorSettings& motor);
/// Returns whether the robot gives an object to this person, picks up an object for the person, or
/// receives an object from the person.
bool in_handover_with(const World& w, const std::string& person);
/// Returns the person whose forearms and hands are exempt from separation while the handover is
/// engaged; empty otherwise.
SeparationExemption handover_exemption(const World& w);
/// Returns the stimulus for a distance [m] and a closing speed [m/s]: the distance, or the time to
/// contact times `urgent_speed` [m/s] if that is less [m], >= 0.
double urgency(double distance, double closing, double urgent_speed);
/// Returns 0 up to `low`, 1 from `high`, linear in between.
double ramp(double x, double low, double high);

}  // namespace handsel::attention
