// SPDX-License-Identifier: Apache-2.0
// Steps of the actions that take two hands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

/// Steps of two hands, or why there are none.
struct TwoHandPlan {
  Outcome outcome;                 ///< whether there is a plan
  std::vector<RegraspStep> steps;  ///< in order
};

/// How two hands bring an object to a place.
enum class HandsUse : std::uint8_t {
  in_turn,          ///< one after the other, the object is put down at the place
  together,         ///< both at once, the object is put down at the place
  together_in_air,  ///< both at once, a person takes the object at the place
};

// References must outlive the routines.
/// Asks for steps that bring an object, which stands or is in the hand in use, to one of the places
/// (T_world_object, at most 64, the best first).
Routine<TwoHandPlan> ask_regrasp(Parts& parts, const std::string& object,
                                 const std::vector<Pose>& places, HandsUse use);
/// Waits until an object is at rest somewhere, for a moment: what was just put down may still seem
/// to be held.
Routine<Outcome> await_put_down(Parts& parts, const std::string& object);
/// Returns where an object of the scene can stand: where the goal says, else free places on its
/// surface, the nearest to an arm first.
std::vector<Pose> places_for(const Parts& parts, const ActionGoal& goal, const SceneObject& object);
/// Opens the hand in use and retreats as `after` is from `closed`, both of all axes [rad, m].
Routine<Outcome> release_and_retreat(Parts& parts, const std::string& object, const Vector& closed,
                                     const Vector& after);

}  // namespace handsel::manipulation_planner
