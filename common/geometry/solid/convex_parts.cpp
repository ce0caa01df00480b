// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/solid/convex_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "common/geometry/solid/convex_hull.hpp"

namespace handsel {
namespace {

using Cells = std::vector<int>;

/// Fraction of a surface cell that counts as solid: half of the cell, plus the loss of the hull of
/// the cell centres by the steps of the grid.
constexpr double kSurfaceFill = 0.8;

/// Returns the volume of the hull of the cell centres outside the cells [m^3].
double concavity_of(const VoxelGrid& grid, const Cells& cells) {
  std::map<std::pair<int, int>, std::pair<int, int>> columns;  // min and max cell
  for (const int i : cells) {
    const auto [x, y, z] = grid.cell_at(i);
    auto [at, is_new] = columns.try_emplace({x, y}, z, z);
    if (is_new) continue;
    at->second.first = std::min(at->second.first, z);
    at->second.second = std::max(at->second.second, z);
  }
  std::vector<Vector3> points;
  for (const auto& [xy, zs] : columns)
    for (const int z : {zs.first, zs.second})
      points.push_back(grid.centre(grid.index(xy.first, xy.second, z)));
  const double hull = volume_of(convex_hull(points));
  double filled = 0;
  for (const int i : cells)
    filled += grid.surface[static_cast<std::size_t>(i)] != 0 ? kSurfaceFill : 1.0;
  return std::max(0.0, hull - grid.cell_volume() * filled);
}

/// Connected components of cells; cells that share a corner are connected.
class Components {
 public:
  explicit Components(const VoxelGrid& grid) : grid_(grid), mark_(grid.solid.size(), 0) {}

  std::vector<Cells> of(const Cells& cells) {
    for (const int i : cells) mark_[static_cast<std::size_t>(i)] = 1;
    std::vector<Cells> out;
    for (const int i : cells) {
      if (mark_[static_cast<std::size_t>(i)] == 0) continue;
      out.push_back(take(i));
    }
    return out;
  }

 private:
  Cells take(int first) {
    Cells out{first};
    mark_[static_cast<std::size_t>(first)] = 0;
    for (std::size_t next = 0; next < out.size(); ++next) {
      const auto [x, y, z] = grid_.cell_at(out[next]);
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int to = grid_.index(x + dx, y + dy, z + dz);  // the grid boundary is empty
            if (mark_[static_cast<std::size_t>(to)] == 0) continue;
            mark_[static_cast<std::size_t>(to)] = 0;
            out.push_back(to);
          }
    }
    return out;
  }

  const VoxelGrid& grid_;
  std::vector<std::uint8_t> mark_;
};

struct Piece {
  Cells cells;
  double concavity{};
};

std::vector<Piece> pieces_of(const VoxelGrid& grid, Components& components, const Cells& cells) {
  std::vector<Piece> out;
  for (Cells& part : components.of(cells)) {
    const double concavity = concavity_of(grid, part);
    out.push_back({std::move(part), concavity});
  }
  return out;
}

double sum_of(const std::vector<Piece>& pieces) {
  double sum = 0;
  for (const Piece& piece : pieces) sum += piece.concavity;
  return sum;
}

/// Returns the cut along an axis with the min remaining concavity, among equal ones the most even.
std::vector<Piece> cut(const VoxelGrid& grid, Components& components, const Cells& cells) {
  constexpr int kPlanes = 9;           // planes tried along an axis
  constexpr double kPieceCost = 0.02;  // per piece beyond two, fraction of the concavity
  std::vector<Piece> best;
  double best_cost = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    int low = grid.size[axis], high = 0;
    for (const int i : cells) {
      low = std::min(low, grid.cell_at(i)[axis]);
      high = std::max(high, grid.cell_at(i)[axis]);
    }
    int before = low;
    for (int k = 1; k <= kPlanes; ++k) {
      const int plane = low + (high - low + 1) * k / (kPlanes + 1);
      if (plane <= before) continue;
      before = plane;
      Cells below, above;
      for (const int i : cells) (grid.cell_at(i)[axis] < plane ? below : above).push_back(i);
      if (below.empty() || above.empty()) continue;
      std::vector<Piece> pieces = pieces_of(grid, components, below);
      for (Piece& piece : pieces_of(grid, components, above)) pieces.push_back(std::move(piece));
      const double uneven =
          std::abs(static_cast<double>(below.size()) - static_cast<double>(above.size())) /
          static_cast<double>(cells.size());
      const double cost = sum_of(pieces) * (1 + kPieceCost * static_cast<double>(pieces.size())) +
                          0.01 * uneven * grid.cell_volume() * static_cast<double>(cells.size());
      if (!best.empty() && cost >= best_cost) continue;
      best_cost = cost;
      best = std::move(pieces);
    }
  }
  return best;
}

/// Returns corners of cells, for pieces whose samples lie in one plane.
std::vector<Vector3> corners_of(const VoxelGrid& grid, const Cells& cells) {
  std::vector<Vector3> out;
  for (const int i : cells)
    for (int k = 0; k < 8; ++k)
      out.push_back(grid.centre(i) +
                    grid.cell * Vector3((k & 1) - 0.5, (k >> 1 & 1) - 0.5, (k >> 2 & 1) - 0.5));
  return out;
}

std::vector<ConvexPart> hulls_of(const VoxelGrid& grid, std::vector<Piece> pieces, int max_points) {
  std::vector<int> owner(grid.solid.size(), -1);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (const int i : pieces[p].cells) owner[static_cast<std::size_t>(i)] = static_cast<int>(p);
  std::vector<std::vector<Vector3>> points(pieces.size());
  for (std::size_t s = 0; s < grid.samples.size(); ++s) {
    const int p = owner[static_cast<std::size_t>(grid.cell_of_sample[s])];
    if (p >= 0) points[static_cast<std::size_t>(p)].push_back(grid.samples[s]);
  }
  std::vector<ConvexPart> out;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (convex_hull(points[p]).triangles.empty()) points[p] = corners_of(grid, pieces[p].cells);
    TriangleMesh hull = convex_hull(points[p]);
    PlacedShape shape = simplest_shape(hull, max_points);
    out.push_back({std::move(hull), std::move(shape), std::move(pieces[p].cells)});
  }
  std::sort(out.begin(), out.end(), [](const ConvexPart& a, const ConvexPart& b) {
    return volume_of(a.hull) > volume_of(b.hull);
  });
  return out;
}

}  // namespace

std::vector<ConvexPart> convex_parts(const VoxelGrid& grid, const ConvexPartsSettings& settings,
                                     const std::function<void(int)>& progress) {
  Cells all;
  for (int i = 0; i < static_cast<int>(grid.solid.size()); ++i)
    if (grid.solid[static_cast<std::size_t>(i)] != 0) all.push_back(i);
  Components components(grid);
  std::vector<Piece> pieces = pieces_of(grid, components, all);
  const double allowed = settings.max_concavity * volume_of(convex_hull(grid.samples));
  while (static_cast<int>(pieces.size()) < settings.max_parts) {
    if (progress) progress(static_cast<int>(pieces.size()));
    const auto worst =
        std::max_element(pieces.begin(), pieces.end(),
                         [](const Piece& a, const Piece& b) { return a.concavity < b.concavity; });
    if (worst == pieces.end() || worst->concavity <= allowed) break;
    std::vector<Piece> parts = cut(grid, components, worst->cells);
    if (parts.empty()) break;
    *worst = std::move(parts.front());
    for (std::size_t k = 1; k < parts.size(); ++k) pieces.push_back(std::move(parts[k]));
  }
  return hulls_of(grid, std::move(pieces), settings.max_points);
}

PlacedShape simplest_shape(const TriangleMesh& hull, int max_points) {
  constexpr double kMinFill = 0.97;  // fraction of the volume of a box or a cylinder
  Vector3 low = hull.vertices.front(), high = low;
  for (const Vector3& v : hull.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Vector3 size = high - low, middle = (low + high) / 2;
  const double volume = volume_of(hull);
  if (volume >= kMinFill * size.prod()) return {Box{size}, make_pose(middle)};
  for (int axis = 0; axis < 3; ++axis) {
    double radius = 0;
    for (const Vector3& v : hull.vertices) {
      Vector3 from = v - middle;
      from[axis] = 0;
      radius = std::max(radius, from.norm());
    }
    if (volume < kMinFill * std::numbers::pi * radius * radius * size[axis]) continue;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), Vector3::Unit(axis));
    return {Cylinder{radius, size[axis]}, make_pose(middle, turn)};
  }
  return {std::make_shared<const TriangleMesh>(reduced_hull(hull.vertices, max_points)),
          Pose::Identity()};
}

}  // namespace handsel
