// SPDX-License-Identifier: Apache-2.0
// Simpler or larger things around others.
#pragma once

#include <vector>

#include "common/collision/collision_shape.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

/// Returns the shape larger by `margin` [m] on every side; of a mesh the box around it, T becomes
/// its pose.
CollisionShapePtr widened(const CollisionShapePtr& shape, double margin, Pose& T);

/// Returns a capsule around points, along their longest extent; its link is left open.
LinkCapsule enclosing_capsule(const std::vector<Vector3>& points);

}  // namespace handsel
