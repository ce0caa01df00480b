// SPDX-License-Identifier: Apache-2.0
// Convex hulls of points, by Bullet.
#pragma once

#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel {

/// Returns the hull as a closed mesh, counter-clockwise seen from outside; without triangles when
/// the points lie in one plane.
TriangleMesh convex_hull(const std::vector<Vector3>& points);

/// Returns the volume inside a closed mesh [m^3]; 0 without triangles.
double volume_of(const TriangleMesh& mesh);

/// Returns the hull of at most `max_points` of the points: the extreme ones in directions
/// spread over the sphere. It lies inside the hull of all.
TriangleMesh reduced_hull(const std::vector<Vector3>& points, int max_points);

}  // namespace handsel
