// SPDX-License-Identifier: Apache-2.0
// Clearance of grasps to the hand of the person who offers the object. The digits of that hand are
// not observed but assumed.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

using GraspIds = std::set<std::uint64_t>;

// References must outlive the routines.
/// Removes the grasps whose approach or closing fingers come nearer than giver_hand_clearance to
/// the giver's hand as observed now, or to its assumed digits. Failure: none is left.
Routine<Outcome> select_clear_of_hand(Parts& parts, const Offer& offer, std::vector<Grasp>& grasps);
/// Returns the ids of the grasps that keep the same clearance also where the giver's hand is turned
/// about its fingers by up to `digits_turn` to either side, while the palm is not observed.
/// nullopt: the check did not end in time.
Routine<std::optional<GraspIds>> clear_of_turned_hand(Parts& parts, const Offer& offer,
                                                      const std::vector<Grasp>& grasps);

}  // namespace handsel::manipulation_planner
