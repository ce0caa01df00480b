// SPDX-License-Identifier: Apache-2.0
// A part of picking that other actions use.
#pragma once

#include <string>

#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

struct Parts;

// References must outlive the routine.
/// Picks an object that is in the scene by the arm in use; `for_human` and `onto` as of pick().
Routine<Outcome> pick_by_arm(Parts& parts, const std::string& object, const std::string& for_human,
                             const std::string& onto);

}  // namespace handsel::manipulation_planner
