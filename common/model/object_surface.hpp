// SPDX-License-Identifier: Apache-2.0
// Distance from a point to the surface of an object's convex parts, in closed form.
#pragma once

#include "common/model/object_model.hpp"

namespace handsel {

/// Returns the distance [m], negative inside; the point is in the object frame. A mesh part counts
/// as its bounding box. +inf without parts.
double surface_distance(const ObjectModel&, const Vector3& p_object);

}  // namespace handsel
