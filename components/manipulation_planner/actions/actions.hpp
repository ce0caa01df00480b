// SPDX-License-Identifier: Apache-2.0
// The actions, as coroutines over the parts of the planner. References must outlive the routines.
#pragma once

#include <string>

#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// Picks an object. `for_human`: who will get it, empty: nobody; `onto`: the surface on which it
/// will be put down, empty: not known.
Routine<Outcome> pick(Parts& parts, const std::string& object, const std::string& for_human,
                      const std::string& onto);
/// Gives the held object to a person; empty: the nearest.
Routine<Outcome> give(Parts& parts, const std::string& object, const std::string& human);
/// Gives an object, from where it stands, to a person with both hands.
Routine<Outcome> give_together(Parts& parts, const ActionGoal& goal);
/// Takes an object from the hand of a person. `wanted` empty: whatever is offered; `giver` empty:
/// any person; `onto`: as of pick(), empty: any surface.
Routine<Outcome> receive(Parts& parts, const std::string& wanted, const std::string& giver,
                         const std::string& onto);
/// Puts the held object down on a surface.
Routine<Outcome> place(Parts& parts, const std::string& object, const std::string& surface);
/// Takes the held object in another hand.
Routine<Outcome> change_hands(Parts& parts, const std::string& object);
/// Brings an object to its goal through two hands, one after the other.
Routine<Outcome> regrasp(Parts& parts, const ActionGoal& goal);
/// Carries an object to its goal with two hands, as a closed chain.
Routine<Outcome> carry(Parts& parts, const ActionGoal& goal);
/// Drives the platform of the robot to where the arm reaches the object, the surface or the person
/// of the goal, else to the place of the goal; the arms rest meanwhile.
Routine<Outcome> drive(Parts& parts, const ActionGoal& goal);
/// Moves all arms to rest.
Routine<Outcome> rest_all(Parts& parts);

}  // namespace handsel::manipulation_planner
