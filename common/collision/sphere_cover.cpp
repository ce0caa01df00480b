// SPDX-License-Identifier: Apache-2.0
#include "common/collision/sphere_cover.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "common/collision/cover/solid_cells.hpp"

namespace handsel {
namespace {

using detail::CoverCandidate, detail::CoverSolid;

constexpr double kRounding =
    2e-6;  // spheres grow by this, to enclose points near corners of cells as well [m]
constexpr int kBallSteps = 48;
constexpr std::size_t kMaxCandidates = 200, kOwnCandidates = 24;  // of one node; of its own cells

/// Returns a nearly minimal ball around points (Badoiu and Clarkson).
CoverNode ball(const CoverSolid& solid, const std::vector<int>& points) {
  Vector3 center = Vector3::Zero();
  for (int i : points)
    center += solid.points[static_cast<std::size_t>(i)] / static_cast<double>(points.size());
  const auto farthest = [&] {
    int best = points.front();
    double max_distance = -1;
    for (int i : points)
      if (const double d = (solid.points[static_cast<std::size_t>(i)] - center).squaredNorm();
          d > max_distance) {
        max_distance = d;
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
  Coverer(CoverSolid solid, const CoverSettings& settings)
      : solid_(std::move(solid)), settings_(settings) {
    if (!solid_.reach) solid_.reach = solid_.depth;
    detail::find_inner(solid_);
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

  /// Returns candidate centres for these cells: deep ones nearby, and ones below the surface.
  std::vector<CoverCandidate> candidates(const CoverNode& node, const std::vector<int>& cells,
                                         double excess, std::size_t level) const {
    std::vector<CoverCandidate> near, out;
    for (const CoverCandidate& c : solid_.inner)
      if (c.depth + excess > 0 && (c.center - node.center).norm() < node.radius) near.push_back(c);
    for (std::size_t i = 0; i < near.size(); i += 1 + near.size() / kMaxCandidates)
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
          out.push_back({q, depth});  // otherwise beyond a thin wall
      }
    }
    return out;
  }

  /// Chooses greedily the sphere that contains the max number of remaining cells. Returns an empty
  /// list if more than `max_count` spheres are needed.
  std::vector<Cluster> choose(const std::vector<CoverCandidate>& tried,
                              const std::vector<int>& cells, double excess, int max_count) const {
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
      if (static_cast<int>(out.size()) == max_count) return {};
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
    const std::vector<CoverCandidate> tried = candidates(node, cells, excess, level);
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

  CoverSolid solid_;
  const CoverSettings& settings_;
  SphereCover cover_;
};

/// Divides the straight part into pieces with one sphere each.
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
  // One sphere per slice of the cylinder; at the ends it also encloses the half sphere.
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
    return Coverer(detail::box_cells(box->size), settings).take();
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return Coverer(detail::cylinder_cells(cylinder->radius, cylinder->length), settings).take();
  return Coverer(detail::mesh_cells(*std::get<MeshPtr>(shape)), settings).take();
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
