// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/solid/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace handsel {
namespace {

constexpr std::array<std::array<int, 3>, 6> kNeighbours{
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

void sample_surface(const TriangleMesh& mesh, VoxelGrid& grid) {
  const double step = grid.cell / 2;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(t[k])];
    };
    const Vector3 u = at(1) - at(0), v = at(2) - at(0);
    const int rows = std::max(1, static_cast<int>(std::ceil(u.norm() / step)));
    for (int i = 0; i <= rows; ++i) {
      const double along = static_cast<double>(i) / rows, rest = 1 - along;
      const int n = std::max(1, static_cast<int>(std::ceil(rest * v.norm() / step)));
      for (int k = 0; k <= n; ++k) grid.samples.push_back(at(0) + along * u + k * rest / n * v);
    }
  }
  grid.cell_of_sample.reserve(grid.samples.size());
  for (const Vector3& p : grid.samples) {
    std::array<int, 3> c{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      c[a] = std::clamp(static_cast<int>((p[axis] - grid.origin[axis]) / grid.cell), 1,
                        grid.size[a] - 2);
    }
    grid.cell_of_sample.push_back(grid.index(c[0], c[1], c[2]));
    grid.solid[static_cast<std::size_t>(grid.cell_of_sample.back())] = 1;
  }
}

/// Calls a function with each of the six neighbours inside the grid.
template <class F>
void each_neighbour(const VoxelGrid& grid, int index, const F& f) {
  const auto [x, y, z] = grid.cell_at(index);
  for (const auto& [dx, dy, dz] : kNeighbours) {
    const int nx = x + dx, ny = y + dy, nz = z + dz;
    if (nx < 0 || ny < 0 || nz < 0 || nx >= grid.size[0] || ny >= grid.size[1] ||
        nz >= grid.size[2])
      continue;
    f(grid.index(nx, ny, nz));
  }
}

void fill_inside(VoxelGrid& grid) {
  std::vector<std::uint8_t> outside(grid.solid.size(), 0);
  std::vector<int> open{0};
  outside[0] = 1;
  while (!open.empty()) {
    const int from = open.back();
    open.pop_back();
    each_neighbour(grid, from, [&](int to) {
      const auto i = static_cast<std::size_t>(to);
      if (outside[i] || grid.solid[i]) return;
      outside[i] = 1;
      open.push_back(to);
    });
  }
  for (std::size_t i = 0; i < grid.solid.size(); ++i) grid.solid[i] = outside[i] ? 0 : 1;
}

}  // namespace

VoxelGrid voxelize(const TriangleMesh& mesh, int resolution) {
  Vector3 low = mesh.vertices.front(), high = low;
  for (const Vector3& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  VoxelGrid grid;
  grid.cell = (high - low).maxCoeff() / resolution;
  for (std::size_t a = 0; a < 3; ++a)
    grid.size[a] =
        3 + static_cast<int>(std::ceil((high - low)[static_cast<Eigen::Index>(a)] / grid.cell));
  const Vector3 extent(grid.size[0], grid.size[1], grid.size[2]);
  grid.origin = (low + high) / 2 - 0.5 * grid.cell * extent;
  grid.solid.assign(static_cast<std::size_t>(grid.size[0]) *
                        static_cast<std::size_t>(grid.size[1]) *
                        static_cast<std::size_t>(grid.size[2]),
                    0);
  sample_surface(mesh, grid);
  grid.surface = grid.solid;
  fill_inside(grid);
  return grid;
}

// Water in a cell rises to the level of the lowest path from the cell to the boundary of the grid:
// priority flood (Barnes, Lehman, Mulla 2014) in three dimensions. The level of a path is its
// highest cell.
std::vector<int> cavity_of(const VoxelGrid& grid) {
  const auto is_solid = [&](int i) { return grid.solid[static_cast<std::size_t>(i)] != 0; };
  std::vector<int> level(grid.solid.size(), -1);
  using Entry = std::pair<int, int>;  // level, cell
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (int i = 0; i < static_cast<int>(grid.solid.size()); ++i) {
    const auto [x, y, z] = grid.cell_at(i);
    const bool rim = x == 0 || y == 0 || x == grid.size[0] - 1 || y == grid.size[1] - 1 || z == 0;
    if (!rim || is_solid(i)) continue;
    level[static_cast<std::size_t>(i)] = z;
    open.emplace(z, i);
  }
  while (!open.empty()) {
    const auto [from_level, from] = open.top();
    open.pop();
    each_neighbour(grid, from, [&, from_level = from_level](int to) {
      if (level[static_cast<std::size_t>(to)] >= 0 || is_solid(to)) return;
      const int to_level = std::max(from_level, grid.cell_at(to)[2]);
      level[static_cast<std::size_t>(to)] = to_level;
      open.emplace(to_level, to);
    });
  }
  std::vector<int> out;
  for (int i = 0; i < static_cast<int>(grid.solid.size()); ++i)
    if (level[static_cast<std::size_t>(i)] > grid.cell_at(i)[2]) out.push_back(i);
  return out;
}

}  // namespace handsel
