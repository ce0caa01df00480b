// SPDX-License-Identifier: Apache-2.0
// Collision and distance of a robot, scene and people; the library handsel::collision.
//
//   CollisionWorld       checks of configurations and straight motions, distances
//   shape_distance()     exact contact and distance of two shapes
#pragma once

#include "common/collision/collision_world.hpp"
#include "common/collision/margins.hpp"
#include "handsel/model.hpp"
