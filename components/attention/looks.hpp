// What several behaviours look at.
#pragma once

#include <limits>
#include <string>

#include "components/attention/schema.hpp"

namespace handsel::attention {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool robot_known(const World& w, const Body& body);
bool doing(const World& w, ActionKind kind);
/// The person who matters: the partner of the action if seen, else the one whose torso is nearest to `p`; null: nobody.
const Person* person_of_interest(const World& w, const Vector3& p, double lost_after);
/// Does a fact of this kind hold about the person? An empty id: about anybody.
bool holds(const World& w, FactKind kind, const std::string& person);
/// Does the person attend to the robot? Yes as long as no facts say otherwise.
bool attentive(const World& w, const std::string& person);

struct NearHand {
  double distance{kInfinity};
  Vector3 position{Vector3::Zero()}, velocity{Vector3::Zero()};
};
NearHand nearest_hand(const Person& person, const Vector3& p);

/// Is this the person whom the robot hands something to or takes something from?
bool exchanges_with(const World& w, const std::string& person);
/// The exchanging forearm and hand, while the exchange is engaged.
Exception exchange_exception(const World& w);
/// Distance, or the time to contact at reference speed 0.5 m/s when that is less: what urgency is judged by [m].
double urgency(double distance, double closing);
/// 0 at `low`, 1 at `high`, straight between.
double ramp(double x, double low, double high);

}  // namespace handsel::attention
