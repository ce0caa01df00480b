// SPDX-License-Identifier: Apache-2.0
// Solids cut into small convex cells: what a cover of spheres has to hold.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel::detail {

/// A centre a sphere may have.
struct CoverCandidate {
  Vector3 center;
  double depth{};  // how far inside the solid [m]
};

/// A solid cut into convex cells, and how deep points are inside it.
struct CoverSolid {
  std::vector<Vector3> points;
  std::vector<std::array<int, 8>> cells;  // the first `corners` of each count
  std::size_t corners{8};
  std::function<double(const Vector3&)> depth;  // < 0 outside
  std::function<double(const Vector3&)> reach;  // the same for points known to be inside; cheaper
  std::vector<CoverCandidate> inner;            // deep centres
  bool volume{};                                // cells fill the solid; else they are its surface
};

/// Cuts a box about the origin.
CoverSolid box_cells(const Vector3& size);
/// Cuts a cylinder about the origin, along z, into rings of wedges.
CoverSolid cylinder_cells(double radius, double length);
/// Cuts the surface of a mesh; ConfigError when it has no triangles.
CoverSolid mesh_cells(const TriangleMesh& mesh);
/// Fills `inner`: a lattice of centres inside the solid, and each moved where it is deeper.
void find_inner(CoverSolid& solid);

}  // namespace handsel::detail
