// Observations that several behaviours share.
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
/// Returns the person of interest: the partner of the action if seen, else the one whose torso is
/// nearest to `p`; null: nobody.
const Person* person_of_interest(const World& w, const Vector3& p, double lost_after);
/// Does a fact of this kind hold about the person? An empty id: about anybody.
bool holds(const World& w, FactKind kind, const std::string& person);
/// Does the person attend to the robot? Yes as long as no facts say otherwise.
bool attentive(const World& w, const std::string& person);

/// The hand of a person that is nearest to a point.
struct NearHand {
  double distance{kInfinity};                                    ///< from the point [m]
  Vector3 position{Vector3::Zero()}, velocity{Vector3::Zero()};  ///< of the hand, world [m], [m/s]
};
/// Returns the hand of the person that is nearest to `p` (world [m]). The person needs all joints.
NearHand nearest_hand(const Person& person, const Vector3& p);

/// Returns by how much the exchange point of a give should move so that the person finds the object
/// at the hand that they extend, world [m]: the wrist of this hand from the planned one, or,
/// where none is planned, the hand from `kBeforeHand` beyond the point. nullopt: no hand is
/// extended, or another one than planned. `p_robot`: where the robot stands, world [m].
std::optional<Vector3> shift_to_extended_hand(const ActionStatus& action, const Person& person,
                                              const Vector3& p_robot, const MotorSettings& motor);
/// Returns whether the robot hands something to this person, picks up what the person is to get, or
/// takes something from the person.
bool in_handover_with(const World& w, const std::string& person);
/// Returns the person whose forearms and hands are exempt from separation while the handover is
/// engaged; empty otherwise.
SeparationExemption handover_exemption(const World& w);
/// Returns the stimulus for a distance [m] and a closing speed [m/s]: the distance, or the time to
/// contact times the reference speed 0.5 m/s when that is less [m], >= 0.
double urgency(double distance, double closing);
/// Returns 0 up to `low`, 1 from `high`, linear in between.
double ramp(double x, double low, double high);

}  // namespace handsel::attention
