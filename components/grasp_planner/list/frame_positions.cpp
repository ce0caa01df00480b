// SPDX-License-Identifier: Apache-2.0
// Positions of the grasp frames in the box of the object: uniform, so that no approach is preferred
// (chapter section 3.2.2).
#include <algorithm>
#include <array>
#include <cmath>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kMaxPositions = 2000;

}  // namespace

std::vector<Vector3> uniform_positions(const Eigen::AlignedBox3d& box, std::uint32_t count) {
  const Vector3 size = box.sizes().cwiseMax(1e-6);
  Eigen::Array3i n(1, 1, 1);
  // A side much shorter than a step has one position; the others divide the rest.
  std::array<bool, 3> thin{};
  for (bool again = true; again;) {
    double product = 1.0 / std::max(1U, count);
    int sides = 0;
    for (int i = 0; i < 3; ++i) {
      if (thin[static_cast<std::size_t>(i)]) continue;
      product *= size[i];
      ++sides;
    }
    again = false;
    const double step = std::pow(product, 1.0 / std::max(1, sides));
    for (int i = 0; i < 3; ++i) {
      if (thin[static_cast<std::size_t>(i)]) continue;
      n[i] = std::max(1, static_cast<int>(std::lround(size[i] / step)));
      if (size[i] < 0.75 * step) again = thin[static_cast<std::size_t>(i)] = true;
    }
  }
  std::vector<Vector3> out;
  for (int z = 0; z < n.z(); ++z) {
    for (int y = 0; y < n.y(); ++y) {
      for (int x = 0; x < n.x(); ++x)
        out.push_back(box.min() + size.cwiseProduct(Vector3((x + 0.5) / n.x(), (y + 0.5) / n.y(),
                                                            (z + 0.5) / n.z())));
    }
  }
  return out;
}

std::uint32_t position_count(const Eigen::AlignedBox3d& box, const GraspListSettings& settings) {
  if (!(settings.spacing > 0)) return settings.positions;
  const double dense =
      std::ceil(box.sizes().cwiseMax(settings.spacing).prod() / std::pow(settings.spacing, 3));
  return static_cast<std::uint32_t>(std::clamp<double>(dense, settings.positions, kMaxPositions));
}

}  // namespace handsel::grasp_planner
