// SPDX-License-Identifier: Apache-2.0
// Where the meshes lie that a URDF names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace handsel {

/// Returns the file of package://name/rest, model://name/rest, file:// or a plain path: in the
/// folder of the URDF and the folders above it, then in `packages`, ROS_PACKAGE_PATH and
/// AMENT_PREFIX_PATH. Throws MissingError when the file is in none of them, ConfigError when the
/// name is longer than 1024 bytes.
std::filesystem::path find_mesh(const std::filesystem::path& urdf, const std::string& uri,
                                const std::vector<std::filesystem::path>& packages);

}  // namespace handsel
