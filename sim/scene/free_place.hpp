// SPDX-License-Identifier: Apache-2.0
// Draws free places on a surface for objects with `free_place` in a scenario.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

using Vector2 = Eigen::Vector2d;

/// A circle on the surface, in the frame of the surface's box [m].
struct TakenCircle {
  Vector2 centre{Vector2::Zero()};  ///< [m]
  double radius{};                  ///< [m]
};

/// A rectangle with sides along the axes of the surface's box, in its frame [m].
struct TakenRectangle {
  Vector2 low{Vector2::Zero()}, high{Vector2::Zero()};  ///< opposite corners [m]
};

/// A surface and the objects on it.
struct Surface {
  Vector2 size{Vector2::Zero()};           ///< full extents of the rectangle around its origin [m]
  std::vector<TakenCircle> circles;        ///< circles around objects
  std::vector<TakenRectangle> rectangles;  ///< boxes that reach through the surface
};

/// Returns the centre of a circle of `radius` with at least `clearance` to all objects on the
/// surface and to its edge [m], uniform over these places; nullopt after 2000 occupied places.
/// `uniform` returns numbers in [0, 1).
std::optional<Vector2> free_place(const Surface& surface, double radius, double clearance,
                                  const std::function<double()>& uniform);

}  // namespace handsel::sim
