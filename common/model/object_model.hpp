// SPDX-License-Identifier: Apache-2.0
// An object that can be handed over: mesh for planning, simple convex parts for physics, mass
// (common/config/object.proto).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel {

/// A convex part of an object, its outline placed in the object frame.
struct ObjectPart : PlacedShape {
  /// What a hollow part consists of, convex, object frame; empty: the part is solid or filled.
  std::vector<PlacedShape> walls{};
};

struct ObjectModel {
  std::string name;               ///< by which scenarios and observations name the model
  TriangleMesh mesh;              ///< object frame, z up when standing [m]
  std::vector<ObjectPart> parts;  ///< convex parts (collision, physics), object frame
  double mass{};                  ///< [kg]
  Vector3 com{Vector3::Zero()};   ///< object frame [m]
  double friction{0.6};           ///< Coulomb coefficient
  double height_above_support{};  ///< of the object frame's origin when standing [m]
  double max_tilt{};  ///< carried with its z axis within this of up; 0: in any orientation [rad]

  /// Returns the physical form, object frame: the parts, the hollow ones by their walls.
  std::vector<PlacedShape> solids() const;

  /// Throws ConfigError / MissingError naming the file and what is wrong.
  static ObjectModel load(const std::filesystem::path& description);
};

}  // namespace handsel
