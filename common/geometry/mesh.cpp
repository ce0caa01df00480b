#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "common/base/errors.hpp"
#include "common/geometry/shape.hpp"

namespace handsel {
namespace {

constexpr std::uintmax_t kMaxBytes = 64u << 20;
constexpr std::size_t kMaxTriangles = 500'000;
constexpr double kLargest = 100, kSmallest = 1e-4;  // [m] nothing a robot has or meets is larger or smaller
constexpr double kWeldGrid = 1e-7;                  // of the file's own unit, relative to its size

using Cell = std::array<long long, 3>;

void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& T_parent, std::vector<aiVector3D>& points,
            std::vector<std::array<int, 3>>& faces) {
  const aiMatrix4x4 T = T_parent * node.mTransformation;
  const bool mirrored = T.Determinant() < 0;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    const int base = static_cast<int>(points.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) points.push_back(T * mesh.mVertices[v]);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<int, 3> t{base + static_cast<int>(face.mIndices[0]), base + static_cast<int>(face.mIndices[1]),
                           base + static_cast<int>(face.mIndices[2])};
      if (mirrored) std::swap(t[1], t[2]);
      faces.push_back(t);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], T, points, faces);
}

}  // namespace

TriangleMesh load_mesh(const std::filesystem::path& file, const Vector3& scale) {
  namespace fs = std::filesystem;
  if (!fs::is_regular_file(file)) throw MissingError("no mesh " + file.string());
  if (fs::file_size(file) > kMaxBytes) throw ConfigError(file.string() + ": larger than 64 MB, the most a mesh may have");
  if (!scale.allFinite() || (scale.array() == 0).any()) throw ConfigError(file.string() + ": a mesh scale must be finite and not 0");

  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw ConfigError(file.string() + ": not a mesh that can be read (" + importer.GetErrorString() + ")");
  std::vector<aiVector3D> points;
  std::vector<std::array<int, 3>> faces;
  append(*scene, *scene->mRootNode, aiMatrix4x4(), points, faces);
  if (faces.size() > kMaxTriangles) throw ConfigError(file.string() + ": more than 500000 triangles, the most a mesh may have");

  double extent = 0;
  for (const auto& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw ConfigError(file.string() + ": has a vertex that is not finite");
    extent = std::max<double>({extent, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  const double grid = std::max(extent * kWeldGrid, 1e-12);
  TriangleMesh mesh;
  std::map<Cell, int> welded;
  std::vector<int> index(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const Cell cell{std::llround(p.x / grid), std::llround(p.y / grid), std::llround(p.z / grid)};
    const auto [it, fresh] = welded.try_emplace(cell, static_cast<int>(mesh.vertices.size()));
    if (fresh) mesh.vertices.emplace_back(p.x * scale.x(), p.y * scale.y(), p.z * scale.z());
    index[i] = it->second;
  }
  const bool mirrored = scale.prod() < 0;
  for (const auto& f : faces) {
    std::array<int, 3> t{index[f[0]], index[f[1]], index[f[2]]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).norm() <= 1e-9 * longest) continue;
    if (mirrored) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
  if (mesh.triangles.empty()) throw ConfigError(file.string() + ": has no triangle with an area");
  Vector3 low = mesh.vertices.front(), high = low;
  for (const Vector3& p : mesh.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (const double size = (high - low).maxCoeff(); size > kLargest || size < kSmallest) {
    char text[120];
    std::snprintf(text, sizeof text, ": is %.3g m large, not between 0.1 mm and 100 m; if its unit is another, give it a scale", size);
    throw ConfigError(file.string() + text);
  }
  return mesh;
}

}  // namespace handsel
