// SPDX-License-Identifier: Apache-2.0
// Three-dimensional pictures: triangles onto coloured points, with depth, light and see-through
// parts. For people, not for time.
#pragma once

#include <functional>
#include <vector>

#include "common/geometry/shape.hpp"
#include "deploy/handsel/pictures/png.hpp"

namespace handsel {

/// Parallel projection.
struct Eye {
  Vector3 target{Vector3::Zero()};      ///< in the middle of the picture
  Vector3 from{Vector3(1, -1.6, 0.9)};  ///< direction from the target to the eye
  Vector3 up{Vector3::UnitZ()};         ///< upward in the picture; any vector not along `from`
  double height{0.4};                   ///< of what the picture shows [m]
};

/// Sees the whole box in a square picture.
Eye eye_on(const Eigen::AlignedBox3d& box, const Vector3& from);

class Canvas {
 public:
  Canvas(int width, int height, const Eye& eye);

  /// Lit on both sides. `opacity` below 1: what is behind shines through.
  void triangle(const Vector3& a, const Vector3& b, const Vector3& c, Colour colour,
                double opacity = 1);
  /// Colours of the corners, between them blended.
  void triangle(const std::array<Vector3, 3>& corners, const std::array<Colour, 3>& colours);
  /// Draws a shape at pose `T`; round shapes as polyhedra of 28 sides.
  void shape(const Shape& shape, const Pose& T, Colour colour, double opacity = 1);
  /// Draws a sphere of this radius [m].
  void ball(const Vector3& centre, double radius, Colour colour, double opacity = 1);
  /// Semi-axes: the columns [m].
  void ellipsoid(const Vector3& centre, const Eigen::Matrix3d& axes, Colour colour,
                 double opacity = 1);
  /// Draws a capsule from `a` to `b`, opaque; nothing when they are equal.
  void stick(const Vector3& a, const Vector3& b, double radius, Colour colour);
  /// `axis`: unit, from the apex; `radius` at its far end.
  void cone(const Vector3& apex, const Vector3& axis, double length, double radius, Colour colour,
            double opacity = 1);
  /// Draws the twelve edges as sticks of this radius [m], at pose `T`.
  void box_edges(const Eigen::AlignedBox3d& box, const Pose& T, double radius, Colour colour);

  /// Everything drawn so far.
  Picture picture() const;

 private:
  struct Sample {
    Eigen::Vector3f colour;
    float depth;
  };
  struct Piece {  // in samples and depth toward the eye
    std::array<Eigen::Vector3f, 3> corners, colours;
    float opacity;
  };
  Eigen::Vector3f project(const Vector3& p) const;
  double light(const Vector3& a, const Vector3& b, const Vector3& c) const;
  void put(const Piece& piece, std::vector<Sample>& samples) const;
  void mesh(const std::vector<Vector3>& vertices, const std::vector<std::array<int, 3>>& triangles,
            const Pose& T, Colour colour, double opacity);

  int width_, height_;
  Eigen::Matrix3d R_eye_world_;
  Vector3 target_;
  double scale_;  // samples a metre
  std::vector<Sample> samples_;
  std::vector<Piece> seen_through_;
};

/// The same scene from several sides, one picture beside the other. Each eye looks at the middle of
/// `box`.
Picture from_sides(const Eigen::AlignedBox3d& box, const std::vector<Vector3>& directions, int size,
                   const std::function<void(Canvas&, std::size_t side)>& draw);

}  // namespace handsel
