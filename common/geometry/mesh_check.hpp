// SPDX-License-Identifier: Apache-2.0
// Checks of a mesh file before the import library sees it: counts against the size of the file,
// indices, finite numbers, depth.
#pragma once

#include <filesystem>
#include <string>

#include "common/geometry/shape.hpp"

namespace handsel::mesh {

/// load_mesh() of a file with this content.
TriangleMesh parse(const std::filesystem::path& file, std::string content, const Vector3& scale);

/// Checks `content` of the file, whose name ends in .obj, .stl, .ply or .dae, and returns what the
/// import library is to read: the content itself, of an OBJ without the names of material files, of
/// a DAE only its geometry and nodes. Throws ConfigError "file:line: ..." (in binary files "file:
/// ...") for what is wrong.
std::string checked(const std::filesystem::path& file, std::string content);

/// Checks an OBJ: coordinates, indices of faces, numbers of vertices and triangles. Returns the
/// content with its mtllib lines as comments.
std::string checked_obj(const std::filesystem::path& file, std::string content);
/// Checks an STL, text or binary: coordinates, and the number of triangles against the size of the
/// file.
void check_stl(const std::filesystem::path& file, const std::string& content);
/// Checks a PLY: its head, and the elements that the head announces.
void check_ply(const std::filesystem::path& file, const std::string& content);
/// Checks a DAE. Returns only its geometry and nodes.
std::string checked_dae(const std::filesystem::path& file, const std::string& content);

}  // namespace handsel::mesh
