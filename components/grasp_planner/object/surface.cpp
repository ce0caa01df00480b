// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/object/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <unordered_map>

#include "common/geometry/placement.hpp"

namespace handsel::grasp_planner {
namespace {

struct Corners {
  Vector3 a, b, c;
};

Corners corners(const TriangleMesh& m, std::size_t t) {
  const auto& k = m.triangles[t];
  return {m.vertices[static_cast<std::size_t>(k[0])], m.vertices[static_cast<std::size_t>(k[1])],
          m.vertices[static_cast<std::size_t>(k[2])]};
}

Vector3 area_vector(const Corners& t) { return 0.5 * (t.b - t.a).cross(t.c - t.a); }

std::uint64_t cell_key(const Eigen::Vector3i& c) {
  const auto part = [](int v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v + (1 << 20))) & 0x1fffffU;
  };
  return part(c.x()) << 42 | part(c.y()) << 21 | part(c.z());
}

Eigen::Vector3i cell_of(const Vector3& p, double size) {
  return (p / size).array().floor().cast<int>();
}

double length_in_ball(const Vector3& a, const Vector3& b, const Vector3& centre, double radius) {
  const Vector3 d = b - a, m = a - centre;
  const double length = d.norm();
  if (length < 1e-12) return 0.0;
  const double along = m.dot(d) / length, q = m.squaredNorm() - radius * radius;
  const double discriminant = along * along - q;
  if (discriminant <= 0) return 0.0;
  const double root = std::sqrt(discriminant);
  return std::max(0.0, std::min(length, -along + root) - std::max(0.0, -along - root));
}

using EdgeMap = std::map<std::pair<int, int>, std::vector<std::pair<std::uint32_t, bool>>>;

// Edge -> triangles that have it, and whether they run through it from the lower to the higher
// vertex.
EdgeMap edges_of(const TriangleMesh& mesh) {
  EdgeMap edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& k = mesh.triangles[t];
    for (std::size_t e = 0; e < 3; ++e) {
      const int a = k[e], b = k[(e + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}].emplace_back(static_cast<std::uint32_t>(t), a < b);
    }
  }
  return edges;
}

}  // namespace

std::vector<SurfacePoint> sample_surface(const TriangleMesh& mesh,
                                         const SurfaceSettings& settings) {
  std::vector<double> cumulative;
  cumulative.reserve(mesh.triangles.size());
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    cumulative.push_back(area += area_vector(corners(mesh, t)).norm());
  if (!(area > 0)) return {};
  const double step = std::max(settings.step, std::sqrt(area / (0.6 * settings.max_points)));
  // Candidates: ten per cell of one step, one per equal part of the area, placed in the triangle
  // by the R2 sequence.
  const auto count = static_cast<std::size_t>(std::ceil(10 * area / (step * step)));
  std::mt19937_64 random(settings.seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const double shift_u = uniform(), shift_v = uniform();
  std::vector<SurfacePoint> candidates;
  candidates.reserve(count);
  std::size_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double target = area * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    while (t + 1 < cumulative.size() && cumulative[t] < target) ++t;
    double u = shift_u + 0.7548776662466927 * static_cast<double>(i),
           v = shift_v + 0.5698402909980532 * static_cast<double>(i);
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Corners k = corners(mesh, t);
    SurfacePoint p;
    p.barycentric = {1 - u - v, u, v};
    p.position = p.barycentric[0] * k.a + u * k.b + v * k.c;
    p.normal = area_vector(k).normalized();
    p.triangle = static_cast<std::uint32_t>(t);
    candidates.push_back(p);
  }
  for (std::size_t i = candidates.size(); i > 1; --i)
    std::swap(candidates[i - 1], candidates[random() % i]);
  // Keep those with no kept neighbour within the step on the same side of the wall.
  std::vector<SurfacePoint> kept;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> grid;
  const double apart = 0.8 * step;
  for (const SurfacePoint& p : candidates) {
    const Eigen::Vector3i cell = cell_of(p.position, apart);
    bool free = true;
    for (int x = -1; x <= 1 && free; ++x) {
      for (int y = -1; y <= 1 && free; ++y) {
        for (int z = -1; z <= 1 && free; ++z) {
          const auto found = grid.find(cell_key(cell + Eigen::Vector3i(x, y, z)));
          if (found == grid.end()) continue;
          for (const std::uint32_t i : found->second) {
            free = free && !(kept[i].normal.dot(p.normal) > 0 &&
                             (kept[i].position - p.position).squaredNorm() < apart * apart);
          }
        }
      }
    }
    if (!free || kept.size() >= settings.max_points) continue;
    grid[cell_key(cell)].push_back(static_cast<std::uint32_t>(kept.size()));
    kept.push_back(p);
  }
  std::vector<Vector3> positions, normals;
  for (const SurfacePoint& p : kept) {
    positions.push_back(p.position);
    normals.push_back(p.normal);
  }
  const std::vector<double> curvature =
      mean_curvature(mesh, positions, normals, settings.curvature_radius);
  for (std::size_t i = 0; i < kept.size(); ++i)
    kept[i].curvature = normalised_curvature(curvature[i], settings.curvature_radius);
  return kept;
}

std::vector<double> mean_curvature(const TriangleMesh& mesh, const std::vector<Vector3>& points,
                                   const std::vector<Vector3>& normals, double radius) {
  struct Bend {
    Vector3 a, b;
    double angle;
    Vector3 facing;  // mean normal of the two triangles
  };
  std::vector<Bend> bends;
  for (const auto& [edge, users] : edges_of(mesh)) {
    double angle = std::numbers::pi;
    Vector3 facing = area_vector(corners(mesh, users[0].first)).normalized();
    if (users.size() >= 2) {
      facing += area_vector(corners(mesh, users[1].first)).normalized();
      const Vector3 n0 = area_vector(corners(mesh, users[0].first)),
                    n1 = area_vector(corners(mesh, users[1].first));
      angle = std::atan2(n0.cross(n1).norm(), n0.dot(n1));
      // Convex when the second triangle lies below the plane of the first.
      const Corners k0 = corners(mesh, users[0].first), k1 = corners(mesh, users[1].first);
      if (n0.dot((k1.a + k1.b + k1.c) - (k0.a + k0.b + k0.c)) > 0) angle = -angle;
    }
    if (std::abs(angle) > 1e-6)
      bends.push_back({mesh.vertices[static_cast<std::size_t>(edge.first)],
                       mesh.vertices[static_cast<std::size_t>(edge.second)], angle, facing});
  }
  // Each bend is entered in every cell that its box, grown by the radius, meets; at most 64 cells
  // along an axis by cutting it.
  const double cell = 2 * radius;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> grid;
  std::vector<Bend> pieces;
  for (const Bend& b : bends) {
    const int parts = std::max(1, static_cast<int>(std::ceil((b.b - b.a).norm() / (2 * cell))));
    for (int k = 0; k < parts; ++k) {
      const Bend piece{b.a + (b.b - b.a) * k / parts, b.a + (b.b - b.a) * (k + 1) / parts, b.angle,
                       b.facing};
      const auto low = cell_of(piece.a.cwiseMin(piece.b).array() - radius, cell),
                 high = cell_of(piece.a.cwiseMax(piece.b).array() + radius, cell);
      for (int x = low.x(); x <= high.x(); ++x) {
        for (int y = low.y(); y <= high.y(); ++y) {
          for (int z = low.z(); z <= high.z(); ++z)
            grid[cell_key({x, y, z})].push_back(static_cast<std::uint32_t>(pieces.size()));
        }
      }
      pieces.push_back(piece);
    }
  }
  std::vector<double> out;
  out.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    double sum = 0;
    if (const auto found = grid.find(cell_key(cell_of(points[k], cell))); found != grid.end()) {
      for (const std::uint32_t i : found->second) {
        if (pieces[i].facing.dot(normals[k]) < -1e-6) continue;
        sum += pieces[i].angle * length_in_ball(pieces[i].a, pieces[i].b, points[k], radius);
      }
    }
    out.push_back(std::abs(sum) / (2 * std::numbers::pi * radius * radius));
  }
  return out;
}

double normalised_curvature(double mean_curvature, double radius) {
  return std::clamp(2 * mean_curvature * radius, 0.0, 1.0);
}

Vector3 mass_centre(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3& v : mesh.vertices) box.extend(v);
  const MassProperties filled = mass_properties(mesh);
  if (filled.volume > 0.02 * box.volume())
    return filled.com.cwiseMax(box.min()).cwiseMin(box.max());
  double area = 0;
  Vector3 by_area = Vector3::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners k = corners(mesh, t);
    const double face = area_vector(k).norm();
    area += face;
    by_area += face * (k.a + k.b + k.c) / 3;
  }
  return area > 0 ? Vector3(by_area / area) : box.center();
}

MeshFindings orient(TriangleMesh& mesh) {
  MeshFindings findings;
  const EdgeMap edges = edges_of(mesh);
  const std::size_t n = mesh.triangles.size();
  std::vector<std::vector<std::pair<std::uint32_t, bool>>> neighbours(
      n);  // triangle, whether one of the two must be flipped
  for (const auto& [edge, users] : edges) {
    findings.open_edges += users.size() == 1;
    findings.crowded_edges += users.size() > 2;
    if (users.size() != 2) continue;
    const bool differ = users[0].second == users[1].second;
    neighbours[users[0].first].emplace_back(users[1].first, differ);
    neighbours[users[1].first].emplace_back(users[0].first, differ);
  }
  struct Component {
    std::vector<std::uint32_t> triangles;
    Eigen::AlignedBox3d box;
    double volume{};
    std::size_t as_given{};
  };
  std::vector<Component> components;
  std::vector<signed char> turn(n, -1);
  for (std::size_t seed = 0; seed < n; ++seed) {
    if (turn[seed] >= 0) continue;
    Component c;
    c.triangles.push_back(static_cast<std::uint32_t>(seed));
    turn[seed] = 0;
    for (std::size_t i = 0; i < c.triangles.size(); ++i) {
      for (const auto& [other, differ] : neighbours[c.triangles[i]]) {
        if (turn[other] >= 0) continue;
        turn[other] =
            static_cast<signed char>(turn[c.triangles[i]] ^ static_cast<signed char>(differ));
        c.triangles.push_back(other);
      }
    }
    for (const std::uint32_t t : c.triangles) {
      const Corners k = corners(mesh, t);
      c.box.extend(k.a);
      c.box.extend(k.b);
      c.box.extend(k.c);
      c.as_given += turn[t] == 0;
    }
    const Vector3 o = c.box.center();
    for (const std::uint32_t t : c.triangles) {
      const Corners k = corners(mesh, t);
      c.volume += (turn[t] ? -1 : 1) * (k.a - o).dot((k.b - o).cross(k.c - o)) / 6;
    }
    components.push_back(std::move(c));
  }
  findings.components = static_cast<std::uint32_t>(components.size());
  for (const Component& c : components) {
    bool inner = false;
    for (const Component& other : components)
      inner = inner ||
              (&other != &c && other.box.contains(c.box) && other.box.volume() > c.box.volume());
    // An inner shell keeps the orientation of most of its given triangles; all other shells face
    // outward.
    const bool flip = inner ? 2 * c.as_given < c.triangles.size() : c.volume < 0;
    for (const std::uint32_t t : c.triangles) {
      if ((turn[t] != 0) == flip) continue;
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      ++findings.turned;
    }
  }
  return findings;
}

MeshFindings mend(TriangleMesh& mesh) {
  double extent = 0;
  for (const Vector3& v : mesh.vertices) extent = std::max(extent, v.cwiseAbs().maxCoeff());
  const double grid = std::max(1e-7 * extent, 1e-12);
  std::map<std::array<long long, 3>, int> known;
  std::vector<Vector3> vertices;
  std::set<std::array<int, 3>> seen;
  std::vector<std::array<int, 3>> triangles;
  const auto index = [&](int old) {
    const Vector3& v = mesh.vertices[static_cast<std::size_t>(old)];
    const auto [at, fresh] = known.try_emplace(
        {std::llround(v.x() / grid), std::llround(v.y() / grid), std::llround(v.z() / grid)},
        static_cast<int>(vertices.size()));
    if (fresh) vertices.push_back(v);
    return at->second;
  };
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles) {
    for (const int v : t) used[static_cast<std::size_t>(v)] = true;
    const std::array<int, 3> k = {index(t[0]), index(t[1]), index(t[2])};
    const auto at = [&](std::size_t i) -> const Vector3& {
      return vertices[static_cast<std::size_t>(k[i])];
    };
    const double longest = std::max({(at(1) - at(0)).squaredNorm(), (at(2) - at(1)).squaredNorm(),
                                     (at(0) - at(2)).squaredNorm()});
    std::array<int, 3> sorted = k;
    std::sort(sorted.begin(), sorted.end());
    if ((at(1) - at(0)).cross(at(2) - at(0)).norm() > 1e-9 * longest && seen.insert(sorted).second)
      triangles.push_back(k);
  }
  const auto before = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  const auto welded = static_cast<std::uint32_t>(before - vertices.size());
  const auto dropped = static_cast<std::uint32_t>(mesh.triangles.size() - triangles.size());
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  MeshFindings findings = orient(mesh);
  findings.welded = welded;
  findings.dropped = dropped;
  return findings;
}

std::vector<std::string> sentences(const MeshFindings& f) {
  std::vector<std::string> out;
  const auto say = [&out](std::uint32_t count, const std::string& what) {
    if (count > 0) out.push_back(std::to_string(count) + " " + what);
  };
  say(f.welded, "vertices were there more than once; they were welded.");
  say(f.dropped, "triangles were without area or repeated; they were left out.");
  say(f.turned, "triangles faced the wrong way; they were turned.");
  say(f.open_edges,
      "edges are borders of holes; the holes were left open, and a place behind them counts as "
      "outside.");
  say(f.crowded_edges,
      "edges are shared by more than two triangles; the parts that meet there were oriented one by "
      "one.");
  if (f.components > 1)
    say(f.components, "parts are not connected; they were taken as one rigid object.");
  return out;
}

}  // namespace handsel::grasp_planner
