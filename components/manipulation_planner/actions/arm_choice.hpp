// SPDX-License-Identifier: Apache-2.0
// Which arm of the robot an action uses.
#pragma once

#include <string>
#include <vector>

#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel {
struct SceneBox;
}

namespace handsel::manipulation_planner {

struct Parts;

// References must outlive the routine.
/// Uses an arm of the robot and its hand for what follows.
Routine<Outcome> use_arm(Parts& parts, const std::string& arm);

/// Returns the point of the top of a box that is nearest to a point, both of the world [m].
Vector3 nearest_on_top(const SceneBox& box, const Vector3& p_world);

/// Returns the arms with a hand that reach a point of the world [m] and, where there is one, a
/// surface; the one that has to stretch least first. Where no arm reaches both, all are returned:
/// the reason of a failure is then that of the nearest. Own method.
std::vector<std::string> arms_for(const Parts& parts, const Vector3& p_world,
                                  const SceneBox* surface);

}  // namespace handsel::manipulation_planner
