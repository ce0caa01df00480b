// SPDX-License-Identifier: Apache-2.0
// Checks the path of a Cartesian motion.
#pragma once

#include <optional>
#include <vector>

#include "components/trajectory_planner/cartesian_motion.hpp"

namespace handsel::trajectory_planner {

/// Returns whether the held object is upright with the tool at T; true without a bound.
bool held_upright(const std::optional<HeldLevel>& held, const Pose& T_root_tool);

/// Returns the index of the first of these successive nearby configurations in contact; their
/// number if none. Checks boxes of configurations at most `step` wide [rad] in batches, then the
/// configurations of boxes that are not clear.
std::size_t first_touching(CollisionWorld& world, const std::vector<Vector>& configurations,
                           double step);

}  // namespace handsel::trajectory_planner
