// SPDX-License-Identifier: Apache-2.0
// Writes an object as files beside its mesh: description, convex parts, the mesh where it is
// another than the user's.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/handsel/offline/object_maker.hpp"

namespace handsel {

/// Where an object is written.
struct ObjectFiles {
  std::filesystem::path mesh;         ///< the user's file
  std::filesystem::path description;  ///< <name>.txtpb
  std::string name;                   ///< in scenarios and observations
  bool replace{};                     ///< files that are there already
};

/// Returns the name of an object from that of a file: letters, digits, "_" and "-", others as "_".
std::string object_name(const std::filesystem::path& file);

/// Writes the description, and into a folder <name>_parts beside it the parts that are no
/// primitives and the mesh when it was moved or simplified, or is of a kind that the page does not
/// draw. Returns the files, the description first. Throws ConfigError when a description is there
/// already, or a file cannot be written.
std::vector<std::filesystem::path> write_object(const MadeObject& made, const ObjectFiles& files);

}  // namespace handsel
