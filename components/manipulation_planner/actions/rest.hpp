// SPDX-License-Identifier: Apache-2.0
// Motions of the arm to rest and out of the area in which people offer objects.
#pragma once

#include <string>

#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// When a motion that clears the offer area ends before its goal.
enum class ClearUntil {
  any_offer,    ///< as soon as the person offers the object
  clear_offer,  ///< as soon as the person offers the object and the area is clear
};

// References must outlive the routines.
/// Moves the arm in use to rest, or as near as leaves people space to offer something.
Routine<Outcome> rest(Parts& parts);
/// Moves all other arms to rest.
Routine<Outcome> rest_others(Parts& parts);
/// Moves the arm in use out of the area in which a person offers objects; empty id: the nearest.
Routine<Outcome> clear_offer_area(Parts& parts, const std::string& giver, ClearUntil until);
/// Moves every arm that occupies that area out of there, the arm in use first: people hold back
/// before the nearest hand, whichever arm it belongs to.
Routine<Outcome> clear_offer_area_of_all(Parts& parts, const std::string& giver, ClearUntil until);

}  // namespace handsel::manipulation_planner
