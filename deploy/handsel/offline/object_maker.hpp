// SPDX-License-Identifier: Apache-2.0
// From a mesh of a user to an object that can be handed over: unit, upright axis, mass, inertia,
// convex parts, cavity. Own method.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/geometry/placement.hpp"
#include "common/model/object_model.hpp"

namespace handsel {

/// What the user says about a mesh; what is left out is found or assumed.
struct ObjectWishes {
  double scale{};          ///< metres a unit of the file; 0: found by the size
  std::string up{"auto"};  ///< axis of the file that is up: x, y, z, -x, -y, -z, auto
  double mass{};           ///< [kg]; 0: by the density
  double density{500};     ///< of the volume inside the surface [kg/m^3]
  double friction{0.6};    ///< Coulomb coefficient
  bool full{};             ///< a container that is carried upright
};

/// An object made of a mesh.
struct MadeObject {
  ObjectModel model;                  ///< origin and mesh as the description will have them
  double scale{1};                    ///< metres a unit of the file
  bool moved{};                       ///< the mesh is another than the file's, scaled
  std::vector<std::string> notes;     ///< what was assumed or mended, one sentence each
  std::vector<Placement> placements;  ///< how the object stands, hardest to tip first
  Vector3 inertia{Vector3::Zero()};   ///< about the com, axes of the object [kg m^2]
  double volume{};                    ///< of the solid [m^3]
  double cavity{};                    ///< held by a container [m^3]; 0: no container
  bool closed{};                      ///< the surface has no holes
};

/// Returns the object. `mesh` is in the unit of its file; `progress` is called with what is done.
/// Throws ConfigError, one sentence, for a mesh without faces or size, or of a size that no unit
/// explains.
MadeObject make_object(TriangleMesh mesh, const ObjectWishes& wishes,
                       const std::function<void(const std::string&)>& progress = {});

/// Returns the mesh with the vertices of each cell of a grid as one, at most about `max_triangles`
/// triangles.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles);

}  // namespace handsel
