// SPDX-License-Identifier: Apache-2.0
// Shapes that can collide. Boxes by full extents; cylinders and capsules along z, length of the
// straight part.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel {

struct TriangleMesh {
  std::vector<Vector3> vertices;              ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// Reads STL, OBJ, PLY or DAE (assimp), welds equal vertices, drops degenerate triangles. Throws
/// MissingError if the file is not there, ConfigError if it cannot be read or exceeds the caps (64
/// MB, 500 000 triangles).
TriangleMesh load_mesh(const std::filesystem::path& file, const Vector3& scale = Vector3::Ones());

struct Sphere {
  double radius;  ///< [m]
};
struct Box {
  Vector3 size;  ///< full extents [m]
};
struct Cylinder {
  double radius;  ///< [m]
  double length;  ///< along z [m]
};
struct Capsule {
  double radius;  ///< [m]
  double length;  ///< of the straight part, along z [m]
};
using MeshPtr = std::shared_ptr<const TriangleMesh>;

using Shape = std::variant<Sphere, Box, Cylinder, Capsule, MeshPtr>;

/// A shape placed in the frame of what it belongs to (a link, an object, the world).
struct PlacedShape {
  Shape shape;                            ///< in its own frame
  Pose T_parent_shape{Pose::Identity()};  ///< its frame in that of the parent
};

}  // namespace handsel
