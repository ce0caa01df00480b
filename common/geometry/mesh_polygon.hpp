// SPDX-License-Identifier: Apache-2.0
// Triangles of a polygon.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::mesh {

/// Adds the triangles of the polygon `corners` (indices into `points`, at least 3, each in range)
/// to `triangles`. A polygon of n corners gives n - 2 triangles of the same orientation; one that
/// is not flat or crosses itself is split all the same. Needs at most n^3 steps.
void split_polygon(const std::vector<Vector3>& points, const std::vector<int>& corners,
                   std::vector<std::array<int, 3>>& triangles);

}  // namespace handsel::mesh
