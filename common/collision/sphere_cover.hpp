// SPDX-License-Identifier: Apache-2.0
// A solid as a tree of spheres that cover it: what the SIMD collision check knows of a robot's link
// or of an object. Own method: the cover holds by construction.
#pragma once

#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel {

/// Sphere of a tree; everything its leaves cover is inside it.
struct CoverNode {
  Vector3 center{Vector3::Zero()};  ///< frame of the shape [m]
  double radius{};                  ///< [m]
  int first_child{}, children{};    ///< children follow each other; none: a leaf
};

struct SphereCover {
  std::vector<CoverNode> nodes;  ///< nodes[0] is the root; parents before children
  int leaves() const;            ///< number of nodes without children
};

struct CoverSettings {
  /// How far the spheres of each level below the root may stand out of the solid [m]; a node that
  /// would need more spheres than it may have children gets larger ones.
  std::vector<double> excess{0.03, 0.01, 0.004};
  int max_children{12};  ///< upper limit of the children of a node
};

/// Spheres around a shape: each point of it is inside at least one leaf. Boxes, cylinders, capsules
/// and spheres are covered as solids, a mesh as its surface, open or closed. By construction: the
/// shape is cut into small convex cells, every cell has all its corners inside the leaf it was
/// given to. Centres are chosen deep inside, where a sphere that stands out little covers much.
SphereCover cover_shape(const Shape& shape, const CoverSettings& settings = {});

/// Several placed shapes under one root.
SphereCover cover_shapes(const std::vector<PlacedShape>& shapes,
                         const CoverSettings& settings = {});

/// Exact: whether every point of every triangle is inside some leaf. A triangle is inside when its
/// corners are in one leaf, else it is cut in four, down to `finest` [m]; pieces smaller than that
/// which no leaf holds count as outside. Independent of how the cover was made.
bool covers(const SphereCover& cover, const TriangleMesh& mesh, double finest = 1e-6);

}  // namespace handsel
