// SPDX-License-Identifier: Apache-2.0
// A mesh as few convex parts, for physics and collision. Own method after V-HACD (Mamou 2016):
// cells of a grid are cut by planes along the axes where the hulls of the pieces fill least that is
// empty.
#pragma once

#include <functional>
#include <vector>

#include "common/geometry/solid/voxels.hpp"

namespace handsel {

/// How far a mesh is cut.
struct ConvexPartsSettings {
  int max_parts{16};           ///< number of parts at which cutting ends
  double max_concavity{0.01};  ///< empty volume in the hull of a part, of the hull of the whole [1]
  int max_points{32};          ///< corners of a hull
};

/// A convex piece of a mesh.
struct ConvexPart {
  TriangleMesh hull;       ///< of all its samples, frame of the mesh [m]
  PlacedShape shape;       ///< simplest_shape() of the hull
  std::vector<int> cells;  ///< of the grid, by index()
};

/// Returns the parts, the largest first; none only when the grid has no samples. `progress` is
/// called with the number of parts so far.
std::vector<ConvexPart> convex_parts(const VoxelGrid& grid, const ConvexPartsSettings& settings,
                                     const std::function<void(int)>& progress = {});

/// Returns the box or the cylinder along an axis that a hull nearly fills, else the hull with at
/// most `max_points` corners.
PlacedShape simplest_shape(const TriangleMesh& hull, int max_points);

}  // namespace handsel
