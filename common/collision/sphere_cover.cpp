#include "common/collision/sphere_cover.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <experimental/simd>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <unordered_map>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

namespace stdx = std::experimental;

constexpr double kLargestCell = 0.008;  // [m]
constexpr double kRounding =
    2e-6;  // spheres grow by this, so that what is near corners of cells is inside, too [m]
constexpr std::size_t kMostTriangles = 20000;
constexpr double kLattice = 300;  // candidate centres in the bounding box
constexpr int kClimbs = 6;        // steps of a candidate away from the nearest surface
constexpr int kBallSteps = 48;
constexpr std::size_t kMostCandidates = 200, kOwnCandidates = 24;  // of one node; of its own cells

struct Candidate {
  Vector3 center;
  double depth{};  // how far inside the solid [m]
};

/// A solid cut into convex cells, and how deep points are inside it.
struct Solid {
  std::vector<Vector3> points;
  std::vector<std::array<int, 8>> cells;  // the first `corners` of each count
  std::size_t corners{8};
  std::function<double(const Vector3&)> depth;  // < 0 outside
  std::function<double(const Vector3&)> reach;  // the same for points known to be inside; cheaper
  std::vector<Candidate> inner;                 // deep centres
  bool volume{};                                // cells fill the solid; else they are its surface
};

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
  return std::clamp(middle / 8, 0.002, kLargestCell * std::max(1.0, extents.maxCoeff() / 0.6));
}

Solid box_cells(const Vector3& size) {
  Solid solid;
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

/// Rings of wedges, the outer corners outside the circle so that their chords hold the arc.
Solid cylinder_cells(double radius, double length) {
  Solid solid;
  solid.volume = true;
  const double cell = cell_size({2 * radius, 2 * radius, length});
  const int sectors = std::clamp(static_cast<int>(std::ceil(2 * M_PI * radius / cell)), 12, 32);
  constexpr std::array<double, 4> ring = {0, 0.5, 0.85, 1};
  constexpr int rings = 3;
  const int slices = std::clamp(static_cast<int>(std::ceil(length / cell)), 1, 24);
  const double outer = radius / std::cos(M_PI / sectors);
  const auto index = [&](int r, int sector, int slice) {
    return (slice * (rings + 1) + r) * sectors + sector % sectors;
  };
  for (int k = 0; k <= slices; ++k)
    for (int r = 0; r <= rings; ++r)
      for (int s = 0; s < sectors; ++s) {
        const double angle = 2 * M_PI * s / sectors, at = outer * ring[static_cast<std::size_t>(r)];
        solid.points.emplace_back(at * std::cos(angle), at * std::sin(angle),
                                  length * (static_cast<double>(k) / slices - 0.5));
      }
  for (int k = 0; k < slices; ++k)
    for (int r = 0; r < rings; ++r)
      for (int s = 0; s < sectors; ++s)
        solid.cells.push_back({index(r, s, k), index(r + 1, s, k), index(r, s + 1, k),
                               index(r + 1, s + 1, k), index(r, s, k + 1), index(r + 1, s, k + 1),
                               index(r, s + 1, k + 1), index(r + 1, s + 1, k + 1)});
  solid.depth = [radius, half = 0.5 * length](const Vector3& p) {
    return std::min(radius - std::hypot(p.x(), p.y()), half - std::abs(p.z()));
  };
  return solid;
}

/// Halves triangles at their longest edge until none is longer than `cell`.
void cut(Solid& solid, const TriangleMesh& mesh, double cell) {
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

/// Very fine meshes: the cubes their triangles pass through.
void cubes(Solid& solid, const TriangleMesh& mesh, double cell) {
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

/// Depth from samples of the surface: nearest of them, and whether the solid angle of the surface
/// says inside.
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
  /// To whole registers: the last point again, no area.
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

Solid mesh_cells(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw ConfigError("a collision mesh has no triangles; it needs at least one");
  Solid solid;
  const Bounds box = bounds(mesh.vertices);
  const Vector3 extents = box.high - box.low;
  if (mesh.triangles.size() > kMostTriangles)
    cubes(solid, mesh, std::max(1e-4, extents.maxCoeff() / 64));
  else
    cut(solid, mesh, std::max(1e-4, cell_size(extents)));
  SampledDepth depth;
  for (const Vector3& p : solid.points) append(depth.point, p);
  const bool surface = mesh.triangles.size() <= kMostTriangles;
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
         i += mesh.triangles.size() / kMostTriangles + 1) {
      const auto& t = mesh.triangles[i];
      sample(at(mesh.vertices, t[0]), at(mesh.vertices, t[1]), at(mesh.vertices, t[2]));
    }
  depth.fill();
  const auto shared = std::make_shared<const SampledDepth>(std::move(depth));
  solid.depth = [shared](const Vector3& p) { return (*shared)(p); };
  solid.reach = [shared](const Vector3& p) { return shared->nearest(p); };
  return solid;
}

/// A lattice of centres inside the solid, and each moved where it is deeper.
void find_inner(Solid& solid) {
  const Bounds box = bounds(solid.points);
  const Vector3 extents = (box.high - box.low).cwiseMax(1e-4);
  const double spacing = std::cbrt(extents.prod() / kLattice);
  const Eigen::Array3i n = (extents.array() / spacing).ceil().max(2.0).min(60.0).cast<int>();
  const auto try_at = [&](const Vector3& p) {
    Candidate best{p, solid.depth(p)};
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

/// Badoiu and Clarkson: a ball around points, near the smallest.
CoverNode ball(const Solid& solid, const std::vector<int>& points) {
  Vector3 center = Vector3::Zero();
  for (int i : points)
    center += solid.points[static_cast<std::size_t>(i)] / static_cast<double>(points.size());
  const auto farthest = [&] {
    int best = points.front();
    double most = -1;
    for (int i : points)
      if (const double d = (solid.points[static_cast<std::size_t>(i)] - center).squaredNorm();
          d > most) {
        most = d;
        best = i;
      }
    return best;
  };
  CoverNode best;
  best.radius = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= kBallSteps; ++k) {
    const Vector3& far = solid.points[static_cast<std::size_t>(farthest())];
    const double radius = (far - center).norm();
    if (radius < best.radius) {
      best.radius = radius;
      best.center = center;
    }
    center += (far - center) / (k + 1.0);
  }
  best.radius += kRounding;
  return best;
}

class Coverer {
 public:
  Coverer(Solid solid, const CoverSettings& settings)
      : solid_(std::move(solid)), settings_(settings) {
    if (!solid_.reach) solid_.reach = solid_.depth;
    find_inner(solid_);
    std::vector<int> all(solid_.cells.size());
    std::iota(all.begin(), all.end(), 0);
    cover_.nodes.push_back(ball(solid_, points_of(all)));
    grow(0, all, 0);
  }
  SphereCover take() { return std::move(cover_); }

 private:
  struct Cluster {
    Vector3 center;
    std::vector<int> cells;
  };

  std::vector<int> points_of(const std::vector<int>& cells) const {
    std::vector<int> out;
    for (int c : cells)
      for (std::size_t i = 0; i < solid_.corners; ++i)
        out.push_back(solid_.cells[static_cast<std::size_t>(c)][i]);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  Vector3 middle(int cell) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < solid_.corners; ++i)
      sum +=
          solid_.points[static_cast<std::size_t>(solid_.cells[static_cast<std::size_t>(cell)][i])];
    return sum / static_cast<double>(solid_.corners);
  }

  /// Centres worth trying for these cells: deep ones nearby, and ones below the surface.
  std::vector<Candidate> candidates(const CoverNode& node, const std::vector<int>& cells,
                                    double excess, std::size_t level) const {
    std::vector<Candidate> near, out;
    for (const Candidate& c : solid_.inner)
      if (c.depth + excess > 0 && (c.center - node.center).norm() < node.radius) near.push_back(c);
    for (std::size_t i = 0; i < near.size(); i += 1 + near.size() / kMostCandidates)
      out.push_back(near[i]);
    if (level == 0) return out;
    const std::size_t stride = 1 + cells.size() / kOwnCandidates;
    for (std::size_t i = 0; i < cells.size(); i += stride) {
      const Vector3 p = middle(cells[i]);
      if (solid_.volume) {
        if (const double depth = solid_.depth(p); depth + excess > 0) out.push_back({p, depth});
        continue;
      }
      const auto& c = solid_.cells[static_cast<std::size_t>(cells[i])];
      const Vector3& a = solid_.points[static_cast<std::size_t>(c[0])];
      const Vector3 n = (solid_.points[static_cast<std::size_t>(c[1])] - a)
                            .cross(solid_.points[static_cast<std::size_t>(c[2])] - a);
      out.push_back({p, 0.0});
      if (!(n.norm() > 0)) continue;
      for (double below : {1.5 * excess, 4 * excess}) {
        const Vector3 q = p - below * n.normalized();
        if (const double depth = solid_.reach(q); depth > 0.7 * below)
          out.push_back({q, depth});  // else beyond a thin wall
      }
    }
    return out;
  }

  /// Greedy: again and again the sphere that holds most cells not held yet. Empty when more than
  /// `most` are needed.
  std::vector<Cluster> choose(const std::vector<Candidate>& tried, const std::vector<int>& cells,
                              double excess, int most) const {
    const std::vector<int> points = points_of(cells);
    std::vector<int> slot(solid_.points.size(), -1);
    for (std::size_t i = 0; i < points.size(); ++i)
      slot[static_cast<std::size_t>(points[i])] = static_cast<int>(i);
    std::vector<std::array<int, 8>> corners(cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
      for (std::size_t i = 0; i < solid_.corners; ++i)
        corners[k][i] =
            slot[static_cast<std::size_t>(solid_.cells[static_cast<std::size_t>(cells[k])][i])];
    const std::size_t words = (cells.size() + 63) / 64;
    std::vector<std::uint64_t> holds(tried.size() * words, 0), left(words, 0);
    for (std::size_t k = 0; k < cells.size(); ++k) left[k / 64] |= std::uint64_t{1} << (k % 64);
    std::vector<char> in(points.size());
    for (std::size_t c = 0; c < tried.size(); ++c) {
      const double reach = tried[c].depth + excess, reach2 = reach * reach;
      for (std::size_t i = 0; i < points.size(); ++i)
        in[i] =
            (solid_.points[static_cast<std::size_t>(points[i])] - tried[c].center).squaredNorm() <=
            reach2;
      for (std::size_t k = 0; k < cells.size(); ++k) {
        char all = 1;
        for (std::size_t i = 0; i < solid_.corners; ++i)
          all &= in[static_cast<std::size_t>(corners[k][i])];
        holds[c * words + k / 64] |= static_cast<std::uint64_t>(all) << (k % 64);
      }
    }
    std::vector<Cluster> out;
    std::size_t open = cells.size();
    while (open > 0) {
      if (static_cast<int>(out.size()) == most) return {};
      std::size_t best = 0;
      int gain = 0;
      for (std::size_t c = 0; c < tried.size(); ++c) {
        int now = 0;
        for (std::size_t w = 0; w < words; ++w)
          now += std::popcount(holds[c * words + w] & left[w]);
        if (now <= gain) continue;
        gain = now;
        best = c;
      }
      Cluster cluster;
      if (gain == 0) {
        for (std::size_t k = 0; k < cells.size() && cluster.cells.empty(); ++k)
          if (left[k / 64] >> (k % 64) & 1) {
            cluster.cells.push_back(cells[k]);
            left[k / 64] &= ~(std::uint64_t{1} << (k % 64));
          }
        cluster.center = ball(solid_, points_of(cluster.cells)).center;
      } else {
        cluster.center = tried[best].center;
        for (std::size_t k = 0; k < cells.size(); ++k)
          if ((holds[best * words + k / 64] & left[k / 64]) >> (k % 64) & 1)
            cluster.cells.push_back(cells[k]);
        for (std::size_t w = 0; w < words; ++w) left[w] &= ~holds[best * words + w];
      }
      open -= cluster.cells.size();
      out.push_back(std::move(cluster));
    }
    return out;
  }

  void grow(int index, const std::vector<int>& cells, std::size_t level) {
    if (level == settings_.excess.size() || cells.size() < 2) return;
    const CoverNode node = cover_.nodes[static_cast<std::size_t>(index)];
    std::vector<Cluster> clusters;
    double excess = settings_.excess[level];
    const double parent = level == 0 ? node.radius : settings_.excess[level - 1];
    const std::vector<Candidate> tried = candidates(node, cells, excess, level);
    for (; clusters.empty() && excess < 0.8 * parent; excess *= 1.4)
      clusters = choose(tried, cells, excess, settings_.max_children);
    if (clusters.empty() || clusters.size() == 1) {
      if (clusters.size() == 1) {
        const CoverNode tighter = around(clusters[0]);
        if (tighter.radius < node.radius || level > 0) {
          const auto at = static_cast<std::size_t>(index);
          cover_.nodes[at].center = tighter.center;
          cover_.nodes[at].radius = tighter.radius;
        }
      }
      grow(index, cells, level + 1);
      return;
    }
    const int first = static_cast<int>(cover_.nodes.size());
    cover_.nodes[static_cast<std::size_t>(index)].first_child = first;
    cover_.nodes[static_cast<std::size_t>(index)].children = static_cast<int>(clusters.size());
    for (const Cluster& cluster : clusters) cover_.nodes.push_back(around(cluster));
    for (std::size_t i = 0; i < clusters.size(); ++i)
      grow(first + static_cast<int>(i), clusters[i].cells, level + 1);
  }

  CoverNode around(const Cluster& cluster) const {
    CoverNode node;
    node.center = cluster.center;
    for (int i : points_of(cluster.cells))
      node.radius =
          std::max(node.radius, (solid_.points[static_cast<std::size_t>(i)] - node.center).norm());
    node.radius += kRounding;
    return node;
  }

  Solid solid_;
  const CoverSettings& settings_;
  SphereCover cover_;
};

/// The straight part in pieces, a sphere around each.
SphereCover capsule_cover(const Capsule& capsule, const CoverSettings& settings) {
  SphereCover cover;
  cover.nodes.push_back({Vector3::Zero(), 0.5 * capsule.length + capsule.radius + kRounding, 0, 0});
  if (!(capsule.length > 0)) return cover;
  const double excess = settings.excess.empty() ? capsule.length : settings.excess.back();
  const double half = std::sqrt(excess * (excess + 2 * capsule.radius));
  const int pieces = std::clamp(static_cast<int>(std::ceil(0.5 * capsule.length / half)), 1, 64);
  const double step = capsule.length / pieces;
  cover.nodes[0].first_child = 1;
  cover.nodes[0].children = pieces + (pieces > 1 ? 0 : 2);
  // A piece: sphere around a slice of the cylinder; at the ends it must hold the half sphere, too.
  if (pieces == 1) {
    cover.nodes[0].first_child = cover.nodes[0].children = 0;
    return cover;
  }
  for (int i = 0; i < pieces; ++i) {
    const double z = -0.5 * capsule.length + (i + 0.5) * step;
    const bool end = i == 0 || i + 1 == pieces;
    cover.nodes.push_back(
        {{0, 0, z},
         (end ? capsule.radius + 0.5 * step : std::hypot(capsule.radius, 0.5 * step)) + kRounding,
         0,
         0});
  }
  return cover;
}

bool triangle_covered(const std::vector<CoverNode>& leaves, const std::vector<int>& near,
                      const std::array<Vector3, 3>& t, double finest) {
  std::vector<int> touching;
  const Vector3 middle = (t[0] + t[1] + t[2]) / 3;
  double reach = 0;
  for (const Vector3& p : t) reach = std::max(reach, (p - middle).norm());
  for (int i : near) {
    const CoverNode& leaf = leaves[static_cast<std::size_t>(i)];
    const double r2 = leaf.radius * leaf.radius;
    if (std::all_of(t.begin(), t.end(),
                    [&](const Vector3& p) { return (p - leaf.center).squaredNorm() <= r2; }))
      return true;
    if ((middle - leaf.center).norm() <= leaf.radius + reach) touching.push_back(i);
  }
  if (touching.empty() || reach < finest) return false;
  const Vector3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
  return triangle_covered(leaves, touching, {ab, bc, ca}, finest) &&
         triangle_covered(leaves, touching, {t[0], ab, ca}, finest) &&
         triangle_covered(leaves, touching, {ab, t[1], bc}, finest) &&
         triangle_covered(leaves, touching, {ca, bc, t[2]}, finest);
}

}  // namespace

int SphereCover::leaves() const {
  return static_cast<int>(std::count_if(nodes.begin(), nodes.end(),
                                        [](const CoverNode& n) { return n.children == 0; }));
}

SphereCover cover_shape(const Shape& shape, const CoverSettings& settings) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return {{{Vector3::Zero(), sphere->radius + kRounding, 0, 0}}};
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return capsule_cover(*capsule, settings);
  if (const auto* box = std::get_if<Box>(&shape))
    return Coverer(box_cells(box->size), settings).take();
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return Coverer(cylinder_cells(cylinder->radius, cylinder->length), settings).take();
  return Coverer(mesh_cells(*std::get<MeshPtr>(shape)), settings).take();
}

SphereCover cover_shapes(const std::vector<PlacedShape>& shapes, const CoverSettings& settings) {
  SphereCover out;
  if (shapes.empty()) return out;
  const bool several = shapes.size() > 1;
  std::vector<SphereCover> parts;
  for (const PlacedShape& placed : shapes) {
    parts.push_back(cover_shape(placed.shape, settings));
    for (CoverNode& node : parts.back().nodes) node.center = placed.T_parent_shape * node.center;
  }
  if (!several) return parts.front();
  out.nodes.resize(1 + parts.size());
  int next = static_cast<int>(out.nodes.size());
  Vector3 middle = Vector3::Zero();
  for (const SphereCover& part : parts)
    middle += part.nodes[0].center / static_cast<double>(parts.size());
  out.nodes[0] = {middle, 0.0, 1, static_cast<int>(parts.size())};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto& nodes = parts[k].nodes;
    const int shift = next - 1;
    out.nodes[0].radius =
        std::max(out.nodes[0].radius, (nodes[0].center - middle).norm() + nodes[0].radius);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      CoverNode node = nodes[i];
      if (node.children > 0) node.first_child += shift;
      if (i == 0)
        out.nodes[1 + k] = node;
      else
        out.nodes.push_back(node);
    }
    next = static_cast<int>(out.nodes.size());
  }
  return out;
}

bool covers(const SphereCover& cover, const TriangleMesh& mesh, double finest) {
  std::vector<CoverNode> leaves;
  for (const CoverNode& node : cover.nodes)
    if (node.children == 0) leaves.push_back(node);
  std::vector<int> all(leaves.size());
  std::iota(all.begin(), all.end(), 0);
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const auto at = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    return triangle_covered(leaves, all, {at(0), at(1), at(2)}, finest);
  });
}

}  // namespace handsel
