// SPDX-License-Identifier: Apache-2.0
#include "common/collision/cover/solid_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <experimental/simd>
#include <limits>
#include <memory>
#include <unordered_map>

#include "common/base/errors.hpp"

namespace handsel::detail {
namespace {

namespace stdx = std::experimental;

constexpr double kMaxCell = 0.008;  // max cell size [m]
constexpr std::size_t kMaxTriangles = 20000;
constexpr double kLattice = 300;  // number of candidate centres in the bounding box
constexpr int kClimbs = 6;        // number of steps of a candidate away from the nearest surface

struct Bounds {
  Vector3 low{Vector3::Constant(std::numeric_limits<double>::infinity())}, high{-low};
  void add(const Vector3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

Bounds bounds(const std::vector<Vector3>& points) {
  Bounds out;
  for (const Vector3& p : points) out.add(p);
  return out;
}

double cell_size(const Vector3& extents) {
  const double middle = extents.sum() - extents.maxCoeff() - extents.minCoeff();
  return std::clamp(middle / 8, 0.002, kMaxCell * std::max(1.0, extents.maxCoeff() / 0.6));
}

}  // namespace

CoverSolid box_cells(const Vector3& size) {
  CoverSolid solid;
  solid.volume = true;
  const double cell = cell_size(size);
  const Eigen::Array3i n = (size.array() / cell).ceil().max(1.0).min(14.0).cast<int>();
  const auto index = [&](int x, int y, int z) { return (z * (n[1] + 1) + y) * (n[0] + 1) + x; };
  for (int z = 0; z <= n[2]; ++z)
    for (int y = 0; y <= n[1]; ++y)
      for (int x = 0; x <= n[0]; ++x)
        solid.points.push_back(size.cwiseProduct(
            Vector3(double(x) / n[0] - 0.5, double(y) / n[1] - 0.5, double(z) / n[2] - 0.5)));
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        std::array<int, 8> corners{};
        for (int c = 0; c < 8; ++c)
          corners[static_cast<std::size_t>(c)] =
              index(x + (c & 1), y + ((c >> 1) & 1), z + (c >> 2));
        solid.cells.push_back(corners);
      }
  solid.depth = [half = Vector3(0.5 * size)](const Vector3& p) {
    return (half - p.cwiseAbs()).minCoeff();
  };
  return solid;
}

/// Returns rings of wedges whose outer corners lie outside the circle, so that their chords enclose
/// the arc.
CoverSolid cylinder_cells(double radius, double length) {
  CoverSolid solid;
  solid.volume = true;
  const double cell = cell_size({2 * radius, 2 * radius, length});
  const int sectors = std::clamp(static_cast<int>(std::ceil(2 * M_PI * radius / cell)), 12, 32);
  constexpr std::array<double, 4> kRing = {0, 0.5, 0.85, 1};
  constexpr int kRings = 3;
  const int slices = std::clamp(static_cast<int>(std::ceil(length / cell)), 1, 24);
  const double outer = radius / std::cos(M_PI / sectors);
  const auto index = [&](int r, int sector, int slice) {
    return (slice * (kRings + 1) + r) * sectors + sector % sectors;
  };
  for (int k = 0; k <= slices; ++k)
    for (int r = 0; r <= kRings; ++r)
      for (int s = 0; s < sectors; ++s) {
        const double angle = 2 * M_PI * s / sectors,
                     at = outer * kRing[static_cast<std::size_t>(r)];
        solid.points.emplace_back(at * std::cos(angle), at * std::sin(angle),
                                  length * (static_cast<double>(k) / slices - 0.5));
      }
  for (int k = 0; k < slices; ++k)
    for (int r = 0; r < kRings; ++r)
      for (int s = 0; s < sectors; ++s)
        solid.cells.push_back({index(r, s, k), index(r + 1, s, k), index(r, s + 1, k),
                               index(r + 1, s + 1, k), index(r, s, k + 1), index(r + 1, s, k + 1),
                               index(r, s + 1, k + 1), index(r + 1, s + 1, k + 1)});
  solid.depth = [radius, half = 0.5 * length](const Vector3& p) {
    return std::min(radius - std::hypot(p.x(), p.y()), half - std::abs(p.z()));
  };
  return solid;
}

namespace {

/// Halves triangles at their longest edge until no edge exceeds `cell` [m].
void cut(CoverSolid& solid, const TriangleMesh& mesh, double cell) {
  solid.points = mesh.vertices;
  solid.corners = 3;
  std::unordered_map<std::uint64_t, int> middles;
  const auto middle = [&](int a, int b) {
    const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) |
                              static_cast<std::uint32_t>(std::max(a, b));
    const auto [it, fresh] = middles.try_emplace(key, static_cast<int>(solid.points.size()));
    if (fresh)
      solid.points.emplace_back(0.5 * (solid.points[static_cast<std::size_t>(a)] +
                                       solid.points[static_cast<std::size_t>(b)]));
    return it->second;
  };
  std::vector<std::array<int, 3>> open(mesh.triangles.begin(), mesh.triangles.end());
  while (!open.empty()) {
    const std::array<int, 3> t = open.back();
    open.pop_back();
    std::size_t longest = 0;
    double length = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double edge = (solid.points[static_cast<std::size_t>(t[i])] -
                           solid.points[static_cast<std::size_t>(t[(i + 1) % 3])])
                              .norm();
      if (edge <= length) continue;
      length = edge;
      longest = i;
    }
    if (length <= cell) {
      solid.cells.push_back({t[0], t[1], t[2], t[2], t[2], t[2], t[2], t[2]});
      continue;
    }
    const int a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3], m = middle(a, b);
    open.push_back({a, m, c});
    open.push_back({m, b, c});
  }
}

/// Adds, for very fine meshes, the cubes that their triangles intersect.
void cubes(CoverSolid& solid, const TriangleMesh& mesh, double cell) {
  std::unordered_map<std::uint64_t, int> corner;
  std::unordered_map<std::uint64_t, bool> seen;
  const Vector3 low = bounds(mesh.vertices).low;
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) << 42 | static_cast<std::uint64_t>(y) << 21 |
           static_cast<std::uint64_t>(z);
  };
  const auto point = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto [it, fresh] =
        corner.try_emplace(key(x, y, z), static_cast<int>(solid.points.size()));
    if (fresh) solid.points.emplace_back(low + cell * Vector3(double(x), double(y), double(z)));
    return it->second;
  };
  for (const auto& t : mesh.triangles) {
    Bounds box;
    for (int i : t) box.add(mesh.vertices[static_cast<std::size_t>(i)]);
    const Eigen::Array<std::int64_t, 3, 1> from =
        ((box.low - low).array() / cell - 1e-9).floor().max(0.0).cast<std::int64_t>();
    const Eigen::Array<std::int64_t, 3, 1> to =
        ((box.high - low).array() / cell + 1e-9).floor().cast<std::int64_t>();
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          if (!seen.try_emplace(key(x, y, z), true).second) continue;
          std::array<int, 8> corners{};
          for (int c = 0; c < 8; ++c)
            corners[static_cast<std::size_t>(c)] =
                point(x + (c & 1), y + ((c >> 1) & 1), z + (c >> 2));
          solid.cells.push_back(corners);
        }
  }
}

/// Depth estimated from samples of the surface: distance to the nearest, and inside or outside by
/// the solid angle of the surface.
struct SampledDepth {
  using F = stdx::native_simd<float>;
  static F row(const std::vector<float>& values, std::size_t i) {
    return F(values.data() + i, stdx::element_aligned);
  }

  std::array<std::vector<float>, 3> point, at,
      area;  // corners; middles and areas (along the normal) of cells

  double nearest(const Vector3& p) const {
    const F x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
            z = static_cast<float>(p.z());
    F least = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < point[0].size(); i += F::size()) {
      const F dx = row(point[0], i) - x, dy = row(point[1], i) - y, dz = row(point[2], i) - z;
      least = min(least, dx * dx + dy * dy + dz * dz);
    }
    return std::sqrt(static_cast<double>(hmin(least)));
  }
  double operator()(const Vector3& p) const {
    const F x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
            z = static_cast<float>(p.z());
    F angle = 0.0f;
    for (std::size_t i = 0; i < at[0].size(); i += F::size()) {
      const F dx = row(at[0], i) - x, dy = row(at[1], i) - y, dz = row(at[2], i) - z,
              d2 = dx * dx + dy * dy + dz * dz + 1e-12f;
      angle +=
          (row(area[0], i) * dx + row(area[1], i) * dy + row(area[2], i) * dz) / (d2 * sqrt(d2));
    }
    return std::abs(static_cast<double>(reduce(angle))) > 2 * M_PI ? nearest(p) : -nearest(p);
  }
  /// Pads to whole registers with the last point, without area.
  void fill() {
    while (point[0].size() % F::size() != 0)
      for (auto& values : point) values.push_back(values.back());
    while (at[0].size() % F::size() != 0)
      for (std::size_t i = 0; i < 3; ++i) {
        at[i].push_back(at[i].back());
        area[i].push_back(0.0f);
      }
  }
};

void append(std::array<std::vector<float>, 3>& rows, const Vector3& v) {
  for (int i = 0; i < 3; ++i) rows[static_cast<std::size_t>(i)].push_back(static_cast<float>(v[i]));
}

}  // namespace

CoverSolid mesh_cells(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw ConfigError("a collision mesh has no triangles; it needs at least one");
  CoverSolid solid;
  const Bounds box = bounds(mesh.vertices);
  const Vector3 extents = box.high - box.low;
  if (mesh.triangles.size() > kMaxTriangles)
    cubes(solid, mesh, std::max(1e-4, extents.maxCoeff() / 64));
  else
    cut(solid, mesh, std::max(1e-4, cell_size(extents)));
  SampledDepth depth;
  for (const Vector3& p : solid.points) append(depth.point, p);
  const bool surface = mesh.triangles.size() <= kMaxTriangles;
  const auto sample = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    append(depth.at, (a + b + c) / 3);
    append(depth.area, 0.5 * (b - a).cross(c - a));
  };
  const auto at = [&](const std::vector<Vector3>& points, int i) -> const Vector3& {
    return points[static_cast<std::size_t>(i)];
  };
  if (surface)
    for (const auto& c : solid.cells)
      sample(at(solid.points, c[0]), at(solid.points, c[1]), at(solid.points, c[2]));
  else
    for (std::size_t i = 0; i < mesh.triangles.size();
         i += mesh.triangles.size() / kMaxTriangles + 1) {
      const auto& t = mesh.triangles[i];
      sample(at(mesh.vertices, t[0]), at(mesh.vertices, t[1]), at(mesh.vertices, t[2]));
    }
  depth.fill();
  const auto shared = std::make_shared<const SampledDepth>(std::move(depth));
  solid.depth = [shared](const Vector3& p) { return (*shared)(p); };
  solid.reach = [shared](const Vector3& p) { return shared->nearest(p); };
  return solid;
}

/// Adds a lattice of centres inside the solid, each moved to greater depth.
void find_inner(CoverSolid& solid) {
  const Bounds box = bounds(solid.points);
  const Vector3 extents = (box.high - box.low).cwiseMax(1e-4);
  const double spacing = std::cbrt(extents.prod() / kLattice);
  const Eigen::Array3i n = (extents.array() / spacing).ceil().max(2.0).min(60.0).cast<int>();
  const auto try_at = [&](const Vector3& p) {
    CoverCandidate best{p, solid.depth(p)};
    if (!(best.depth > 0)) return;
    solid.inner.push_back(best);
    double step = 0.4 * spacing;
    for (int i = 0, axis = 0, vain = 0; i < kClimbs; ++i, axis = (axis + 1) % 3) {
      bool moved = false;
      for (double side : {-1.0, 1.0}) {
        const Vector3 q = best.center + side * step * Vector3::Unit(axis);
        if (step >= best.depth) continue;
        const double depth = solid.reach(q);
        if (depth <= best.depth + 1e-6) continue;
        best = {q, depth};
        moved = true;
        break;
      }
      vain = moved ? 0 : vain + 1;
      if (vain == 3) step *= 0.5;
    }
    solid.inner.push_back(best);
  };
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        try_at(box.low +
               extents.cwiseProduct(Vector3((x + 0.5) / n[0], (y + 0.5) / n[1], (z + 0.5) / n[2])));
  solid.inner.push_back({0.5 * (box.low + box.high), solid.depth(0.5 * (box.low + box.high))});
}

}  // namespace handsel::detail
