// SPDX-License-Identifier: Apache-2.0
// Parts of putting down that other actions use.
#pragma once

#include <string>

#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/placing/place_search.hpp"

namespace handsel::manipulation_planner {

// References must outlive the routines.
/// Asks for grasps that serve at a free place of the surface too, which place() then tries first;
/// if there is none, for any.
Routine<GraspList> ask_grasps_onto(Parts& parts, const std::string& object,
                                   const std::string& surface);
/// Puts the held object on a surface. `taker`: arm that will take it from there; empty: none.
Routine<Outcome> put_on(Parts& parts, const std::string& object, const std::string& surface,
                        const std::string& taker);
/// Moves what is held to above one of the places and down to it; which one is up to the path.
Routine<Outcome> lower(Parts& parts, std::vector<PlacingConfiguration> places);

}  // namespace handsel::manipulation_planner
