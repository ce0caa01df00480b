// Room about people's heads: where an arm may only creep, a path that leads by is no short one.
// Pure. Own method.
#pragma once

#include <vector>

#include "common/collision/collision_world.hpp"

namespace handsel::path_planner {

/// Makes spheres about the heads obstacles of the world, larger than the heads by `room` [m] or by
/// the largest fraction of it at which `start` and one of `goals` (all axes) are free: what stands
/// nearer must be able to leave, what is held near a head be reached. Returns the room that is
/// kept [m]; at 0 there are no such obstacles. Everything else of the world is set before.
double keep_clear_of_heads(CollisionWorld& world, const HumanState& people, double room,
                           const Vector& start, const std::vector<Vector>& goals);

}  // namespace handsel::path_planner
