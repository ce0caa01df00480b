// Checks of the path of a Cartesian motion.
#pragma once

#include <optional>
#include <vector>

#include "components/trajectory_planner/cartesian_motion.hpp"

namespace handsel::trajectory_planner {

/// Returns whether what is held is upright with the tool at T; true when nothing is held.
bool held_upright(const std::optional<HeldLevel>& held, const Pose& T_root_tool);

/// Returns the index of the first of these configurations, one near the next, that touches
/// something; their number where none does. Boxes of configurations around some of them, at most
/// `step` wide [rad], and what lies between, are checked side by side; those that are not clear
/// configuration by configuration.
std::size_t first_touching(CollisionWorld& world, const std::vector<Vector>& configurations,
                           double step);

}  // namespace handsel::trajectory_planner
