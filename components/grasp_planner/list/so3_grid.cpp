// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/so3_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace handsel::grasp_planner {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kBaseCells = 72;
constexpr std::uint64_t kBaseAngles = 6;

struct SpherePoint {
  double theta, phi;
};

// Centre of pixel (face, x, y) of the HEALPix partition with `nside` pixels along each side of its
// twelve faces.
SpherePoint healpix_centre(int face, std::uint64_t x, std::uint64_t y, std::uint64_t nside) {
  static constexpr std::array<int, 12> kRing = {2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4};
  static constexpr std::array<int, 12> kColumn = {1, 3, 5, 7, 0, 2, 4, 6, 1, 3, 5, 7};
  const auto n = static_cast<long>(nside), ix = static_cast<long>(x), iy = static_cast<long>(y);
  const long ring = kRing[static_cast<std::size_t>(face)] * n - ix - iy - 1;
  long across = n;
  double z = 0;
  long shift = 0;
  if (ring < n) {
    across = ring;
    z = 1.0 - static_cast<double>(across * across) / (3.0 * static_cast<double>(n * n));
  } else if (ring > 3 * n) {
    across = 4 * n - ring;
    z = -1.0 + static_cast<double>(across * across) / (3.0 * static_cast<double>(n * n));
  } else {
    z = static_cast<double>(2 * n - ring) * 2.0 / (3.0 * static_cast<double>(n));
    shift = (ring - n) & 1;
  }
  long column = (kColumn[static_cast<std::size_t>(face)] * across + ix - iy + 1 + shift) / 2;
  if (column > 4 * n) column -= 4 * n;
  if (column < 1) column += 4 * n;
  const double phi = (static_cast<double>(column) - 0.5 * static_cast<double>(shift + 1)) *
                     (kPi / 2) / static_cast<double>(across);
  return {std::acos(std::clamp(z, -1.0, 1.0)), phi};
}

Eigen::Quaterniond hopf(const SpherePoint& s, double psi) {
  const double c = std::cos(s.theta / 2), k = std::sin(s.theta / 2);
  return {c * std::cos(psi / 2), c * std::sin(psi / 2), k * std::cos(s.phi + psi / 2),
          k * std::sin(s.phi + psi / 2)};
}

// Order in which the 72 base cells are visited: each next one farthest from those before.
std::vector<std::uint64_t> spread_order() {
  std::vector<Eigen::Quaterniond> cells;
  for (std::uint64_t i = 0; i < kBaseCells; ++i) cells.push_back(so3_grid_cell(0, i));
  std::vector<double> nearest(kBaseCells, -1.0);
  std::vector<std::uint64_t> order = {0};
  std::vector<bool> used(kBaseCells, false);
  used[0] = true;
  while (order.size() < kBaseCells) {
    std::uint64_t best = kBaseCells;
    for (std::uint64_t i = 0; i < kBaseCells; ++i) {
      nearest[i] = std::max(nearest[i], std::abs(cells[i].dot(cells[order.back()])));
      if (!used[i] && (best == kBaseCells || nearest[i] < nearest[best] - 1e-12)) best = i;
    }
    used[best] = true;
    order.push_back(best);
  }
  return order;
}

}  // namespace

std::uint64_t so3_grid_size(int level) { return kBaseCells << (3 * level); }

Eigen::Quaterniond so3_grid_cell(int level, std::uint64_t index) {
  std::uint64_t x = 0, y = 0, turn = 0;
  for (int l = 0; l < level; ++l) {
    const std::uint64_t child = (index >> (3 * l)) & 7U;
    x |= (child & 1U) << l;
    y |= ((child >> 1) & 1U) << l;
    turn |= ((child >> 2) & 1U) << l;
  }
  const std::uint64_t base = index >> (3 * level);
  const std::uint64_t nside = 1ULL << level;
  turn += (base % kBaseAngles) * nside;
  const double psi =
      2 * kPi * (static_cast<double>(turn) + 0.5) / static_cast<double>(kBaseAngles * nside);
  return hopf(healpix_centre(static_cast<int>(base / kBaseAngles), x, y, nside), psi);
}

std::vector<Eigen::Quaterniond> so3_sequence(std::uint64_t count) {
  static constexpr std::array<std::uint64_t, 8> kChildren = {0, 7, 3, 4, 5, 2, 6, 1};
  std::vector<Eigen::Quaterniond> out;
  out.reserve(count);
  std::vector<std::uint64_t> cells = spread_order();
  for (int level = 0; out.size() < count; ++level) {
    for (const std::uint64_t cell : cells) {
      if (out.size() == count) return out;
      out.push_back(so3_grid_cell(level, cell));
    }
    std::vector<std::uint64_t> next;
    next.reserve(cells.size() * 8);
    for (const std::uint64_t child : kChildren) {
      for (const std::uint64_t cell : cells) next.push_back(cell * 8 + child);
    }
    cells = std::move(next);
  }
  return out;
}

}  // namespace handsel::grasp_planner
