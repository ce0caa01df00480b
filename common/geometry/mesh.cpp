// SPDX-License-Identifier: Apache-2.0
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/geometry/mesh_check.hpp"
#include "common/geometry/mesh_polygon.hpp"
#include "common/geometry/mesh_text.hpp"
#include "common/geometry/shape.hpp"

namespace handsel {
namespace {

constexpr double kMaxExtent = 100,
                 kMinExtent = 1e-4;  // range of plausible sizes of a mesh [m]
constexpr double kWeldGrid = 1e-7;   // relative to the size of the mesh, in the unit of the file

using Cell = std::array<long long, 3>;

struct Soup {
  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> faces;
};

/// Adds the polygons of a mesh, and their vertices, to the soup. Points and lines are skipped.
void append(const aiMesh& mesh, const aiMatrix4x4& T, const std::filesystem::path& file,
            Soup& soup) {
  std::vector<int> place(mesh.mNumVertices, -1);
  for (unsigned f = 0; f < mesh.mNumFaces; ++f)
    for (unsigned i = 0; mesh.mFaces[f].mNumIndices >= 3 && i < mesh.mFaces[f].mNumIndices; ++i)
      place[mesh.mFaces[f].mIndices[i]] = 0;
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    if (place[v] < 0) continue;
    place[v] = static_cast<int>(soup.points.size());
    const aiVector3D p = T * mesh.mVertices[v];
    soup.points.emplace_back(p.x, p.y, p.z);
  }
  const std::size_t first = soup.faces.size();
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3) continue;
    std::vector<int> corners(face.mIndices, face.mIndices + face.mNumIndices);
    for (int& corner : corners) corner = place[static_cast<std::size_t>(corner)];
    mesh::split_polygon(soup.points, corners, soup.faces);
    if (soup.faces.size() > mesh::kMaxTriangles || soup.points.size() > mesh::kMaxVertices)
      throw ConfigError(file.string() +
                        ": more than 500000 triangles or 1500000 vertices, the maximum of a mesh");
  }
  if (T.Determinant() >= 0) return;
  for (std::size_t t = first; t < soup.faces.size(); ++t)
    std::swap(soup.faces[t][1], soup.faces[t][2]);
}

/// Adds the meshes of a node to the soup. A mesh may belong to several nodes: the bounds count each
/// use.
void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& T_parent,
            const std::filesystem::path& file, Soup& soup) {
  const aiMatrix4x4 T = T_parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m)
    append(*scene.mMeshes[node.mMeshes[m]], T, file, soup);
  for (unsigned c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], T, file, soup);
}

/// Throws ConfigError if a face refers to a vertex that its mesh does not have.
void check_indices(const aiScene& scene, const std::filesystem::path& file) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      for (unsigned i = 0; i < mesh.mFaces[f].mNumIndices; ++i)
        if (mesh.mFaces[f].mIndices[i] >= mesh.mNumVertices)
          throw ConfigError(file.string() + ": face " + std::to_string(f + 1) + " has vertex " +
                            std::to_string(mesh.mFaces[f].mIndices[i]) +
                            ", out of range: there are " + std::to_string(mesh.mNumVertices));
  }
}

std::string read(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  if (!fs::exists(file)) throw MissingError("mesh " + file.string() + " does not exist");
  if (!fs::is_regular_file(file)) throw ConfigError(file.string() + " is not a file");
  if (fs::file_size(file) > mesh::kMaxBytes)
    throw ConfigError(file.string() + ": larger than 64 MB, the maximum of a mesh");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw ConfigError(file.string() + ": cannot be read");
  return text.str();
}

Soup import(const std::filesystem::path& file, std::string given) {
  const std::string content = mesh::checked(file, std::move(given));
  Assimp::Importer importer;
  // Imports from memory, so that files it names are not read. Without post-processing, which relies
  // on valid indices.
  const aiScene* scene =
      importer.ReadFileFromMemory(content.data(), content.size(), 0, file.extension().c_str() + 1);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw ConfigError(file.string() + ": not a mesh that can be read (" +
                      mesh::shown(importer.GetErrorString()) + ")");
  check_indices(*scene, file);
  Soup soup;
  append(*scene, *scene->mRootNode, aiMatrix4x4(), file, soup);
  if (soup.faces.empty())
    throw ConfigError(file.string() + ": not a mesh that can be read: it has no faces");
  return soup;
}

}  // namespace

TriangleMesh mesh::parse(const std::filesystem::path& file, std::string content,
                         const Vector3& scale) {
  if (!scale.allFinite() || (scale.array() == 0).any())
    throw ConfigError(file.string() + ": a mesh scale must be finite and not 0");
  const auto [points, faces] = import(file, std::move(content));

  double extent = 0;
  for (const auto& p : points) {
    if (!p.allFinite()) throw ConfigError(file.string() + ": has a vertex that is not finite");
    extent = std::max(extent, p.cwiseAbs().maxCoeff());
  }
  const double grid = std::max(extent * kWeldGrid, 1e-12);
  TriangleMesh mesh;
  std::map<Cell, int> welded;
  std::vector<int> index(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const Cell cell{std::llround(p.x() / grid), std::llround(p.y() / grid),
                    std::llround(p.z() / grid)};
    const auto [it, fresh] = welded.try_emplace(cell, static_cast<int>(mesh.vertices.size()));
    if (fresh) mesh.vertices.emplace_back(p.cwiseProduct(scale));
    index[i] = it->second;
  }
  const bool mirrored = scale.prod() < 0;
  for (const auto& f : faces) {
    std::array<int, 3> t{index[f[0]], index[f[1]], index[f[2]]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double max_edge =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).norm() <= 1e-9 * max_edge) continue;
    if (mirrored) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
  if (mesh.triangles.empty()) throw ConfigError(file.string() + ": has no triangle with an area");
  Vector3 low = mesh.vertices.front(), high = low;
  for (const Vector3& p : mesh.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (const double size = (high - low).maxCoeff(); size > kMaxExtent || size < kMinExtent) {
    char text[120];
    std::snprintf(
        text, sizeof text,
        ": is %.3g m large, not between 0.1 mm and 100 m; if its unit is another, give it a scale",
        size);
    throw ConfigError(file.string() + text);
  }
  return mesh;
}

TriangleMesh load_mesh(const std::filesystem::path& file, const Vector3& scale) {
  return mesh::parse(file, read(file), scale);
}

}  // namespace handsel
