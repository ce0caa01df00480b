// SPDX-License-Identifier: Apache-2.0
// How an object stays where it is put down, and how its mass is spread. Own method.
#pragma once

#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel {

/// Of a closed surface filled evenly.
struct MassProperties {
  double volume{};               ///< [m^3]; not above 0: the surface is open or inside out
  Vector3 com{Vector3::Zero()};  ///< frame of the mesh [m]
  /// About the com, axes of the mesh [m^2].
  Eigen::Matrix3d inertia_per_mass{Eigen::Matrix3d::Zero()};
};
/// Returns volume, centre and inertia of the volume inside the mesh.
MassProperties mass_properties(const TriangleMesh& mesh);

/// A face of the convex hull over which the mass centre stands.
struct Placement {
  /// Support: plane z = 0, up is z; the mass centre is on the z axis.
  Pose T_support_object{Pose::Identity()};
  double height{};   ///< of the mass centre [m]
  double margin{};   ///< from below the mass centre to the nearest edge it could tip over [m]
  double tipping{};  ///< tilt of the support at which it tips over [rad]
  double area{};     ///< of the face [m^2]
};

/// Hardest to tip over first; at most one for each face, those that tip below `min_tipping` [rad]
/// left out. Faces whose normals differ by less than a degree are one. Empty for meshes without
/// volume.
std::vector<Placement> stable_placements(const TriangleMesh& mesh, const Vector3& com,
                                         double min_tipping = 0.1);

}  // namespace handsel
