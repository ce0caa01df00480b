// SPDX-License-Identifier: Apache-2.0
// Clearance to people's heads: near heads the arm is slow, so that a path with clearance is faster.
// Pure. Own method.
#pragma once

#include <vector>

#include "common/collision/collision_world.hpp"

namespace handsel::path_planner {

/// Adds spheres about the heads to the world's obstacles, larger than the heads by `room` [m], or
/// by the max fraction of it at which `start` and one of `goals` (all axes) are free. Returns the
/// clearance [m]; 0: no obstacles were added. To be called after all other settings of the world.
double keep_clear_of_heads(CollisionWorld& world, const HumanState& people, double room,
                           const Vector& start, const std::vector<Vector>& goals);

}  // namespace handsel::path_planner
