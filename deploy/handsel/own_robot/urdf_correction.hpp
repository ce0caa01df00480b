// SPDX-License-Identifier: Apache-2.0
// Corrects what is often wrong in the URDF of a user: meshes in millimetres, links without
// collision shapes, masses and efforts of 0. What cannot be corrected is refused in one sentence.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace handsel {

/// Bounds and assumed values of the correction. Own method.
struct UrdfAssumptions {
  double max_mesh{3};         ///< a mesh with a longer side is in millimetres [m]
  double max_origin{10};      ///< a joint with a larger offset is in millimetres [m]
  double max_angle{13};       ///< a larger limit of a joint is in degrees [rad]
  double unlimited{1000};     ///< a larger limit of a joint means none [rad]
  double density{1500};       ///< of links without a mass, of the capsules around them [kg/m^3]
  double min_mass{0.01};      ///< of a link without a mass [kg]
  double effort{100};         ///< of joints without an effort [Nm] or [N]
  double turning_speed{1};    ///< of joints that turn and have no velocity [rad/s]
  double sliding_speed{0.1};  ///< of joints that slide and have no velocity [m/s]
};

/// A URDF to be corrected.
struct UrdfSource {
  std::filesystem::path file;                   ///< of the user
  std::vector<std::filesystem::path> packages;  ///< further folders of package://
  std::filesystem::path copy;                   ///< is written when something was corrected
  UrdfAssumptions assumed;                      ///< bounds and assumed values
};

/// A URDF that can be used.
struct CorrectedUrdf {
  std::filesystem::path file;      ///< the user's, or the corrected copy
  std::vector<std::string> notes;  ///< one sentence for each correction
};

/// Returns a URDF that RobotModel can load, with collision shapes, masses, efforts and velocities.
/// Throws ConfigError or MissingError with one sentence: unexpanded xacro, lengths in millimetres,
/// angles in degrees, missing meshes, meshes with y up, and what RobotModel refuses.
CorrectedUrdf correct_urdf(const UrdfSource& source);

}  // namespace handsel
