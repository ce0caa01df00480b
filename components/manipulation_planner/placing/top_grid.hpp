// SPDX-License-Identifier: Apache-2.0
// Grid of points on top of a box. Pure.
#pragma once

#include <vector>

#include "common/messages/world.hpp"

namespace handsel::manipulation_planner {

/// Returns points on top of the box (world frame [m]): from one end to the other of each horizontal
/// side, with a margin of `edge` to the sides and at a distance of `spacing` from each other [m];
/// along a side shorter than twice the margin the middle alone. Own method.
std::vector<Vector3> top_grid(const SceneBox& box, double edge, double spacing);

}  // namespace handsel::manipulation_planner
