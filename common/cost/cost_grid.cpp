// SPDX-License-Identifier: Apache-2.0
#include "common/cost/cost_grid.hpp"

#include <algorithm>
#include <cmath>

namespace handsel {
namespace {

constexpr std::uint8_t kForbidden = 255;
constexpr double kMaxLevel = 254;

}  // namespace

std::string CostGrid::fault(const Costmap& map) {
  const std::string layer = "cost layer \"" + map.layer + "\"";
  if (!(map.resolution > 0))
    return layer + ": its resolution is " + std::to_string(map.resolution) + ", it must be > 0";
  if (map.nx < 2 || map.ny < 2 || map.nz < 2)
    return layer + ": it needs at least two points along each axis";
  if (const std::size_t points = std::size_t{map.nx} * map.ny * map.nz; map.values.size() != points)
    return layer + ": it has " + std::to_string(map.values.size()) + " values for " +
           std::to_string(points) + " points";
  if (!map.origin.allFinite() || !(map.weight >= 0))
    return layer + ": its origin and weight must be finite, the weight not below 0";
  return {};
}

CostGrid::CostGrid(Costmap map)
    : map_(std::move(map)),
      forbids_(std::find(map_.values.begin(), map_.values.end(), kForbidden) != map_.values.end()) {
}

/// The eight grid points around a position: their values and the position between them.
struct CostGrid::Cell {
  double f[3];        // position between the lower and the upper points, [0, 1]
  std::uint8_t v[8];  // values, x fastest
  double weight(int corner) const {
    return (corner & 1 ? f[0] : 1 - f[0]) * (corner & 2 ? f[1] : 1 - f[1]) *
           (corner & 4 ? f[2] : 1 - f[2]);
  }
};

bool CostGrid::find(const Vector3& p_world, Cell& cell) const {
  const std::uint32_t size[3] = {map_.nx, map_.ny, map_.nz};
  std::size_t low[3];
  for (int i = 0; i < 3; ++i) {
    const double at = (p_world[i] - map_.origin[i]) / map_.resolution;
    if (!(at >= 0 && at <= size[i] - 1)) return false;
    low[i] = std::min<std::size_t>(static_cast<std::size_t>(at), size[i] - 2);
    cell.f[i] = at - static_cast<double>(low[i]);
  }
  const std::uint8_t* first = map_.values.data() + (low[2] * map_.ny + low[1]) * map_.nx + low[0];
  const std::size_t row = map_.nx, plane = std::size_t{map_.nx} * map_.ny;
  for (int corner = 0; corner < 8; ++corner)
    cell.v[corner] =
        first[(corner & 1 ? 1 : 0) + (corner & 2 ? row : 0) + (corner & 4 ? plane : 0)];
  return true;
}

GridValue CostGrid::value(const Vector3& p_world) const {
  Cell cell;
  if (!find(p_world, cell)) return {};
  double sum = 0, weight = 0;
  for (int corner = 0; corner < 8; ++corner) {
    if (cell.v[corner] == kForbidden) continue;
    const double w = cell.weight(corner);
    weight += w;
    sum += w * cell.v[corner];
  }
  return {weight > 0 ? sum / (kMaxLevel * weight) : 1.0, Vector3::Zero(), true, weight <= 0.5};
}

GridValue CostGrid::at(const Vector3& p_world) const {
  Cell cell;
  if (!find(p_world, cell)) return {};
  double sum = 0, weight = 0;
  Vector3 d_sum = Vector3::Zero(), d_weight = Vector3::Zero();  // per cell, along the axes
  for (int corner = 0; corner < 8; ++corner) {
    if (cell.v[corner] == kForbidden) continue;
    const double x = corner & 1 ? cell.f[0] : 1 - cell.f[0],
                 y = corner & 2 ? cell.f[1] : 1 - cell.f[1],
                 z = corner & 4 ? cell.f[2] : 1 - cell.f[2];
    const Vector3 slope((corner & 1 ? 1 : -1) * y * z, (corner & 2 ? 1 : -1) * x * z,
                        (corner & 4 ? 1 : -1) * x * y);
    weight += x * y * z;
    sum += x * y * z * cell.v[corner];
    d_weight += slope;
    d_sum += cell.v[corner] * slope;
  }
  if (weight <= 0) return {1.0, Vector3::Zero(), true, true};
  return {sum / (kMaxLevel * weight),
          (d_sum * weight - sum * d_weight) / (weight * weight * kMaxLevel * map_.resolution), true,
          weight <= 0.5};
}

}  // namespace handsel
