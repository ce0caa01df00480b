// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/placing/top_grid.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::manipulation_planner {

std::vector<Vector3> top_grid(const SceneBox& box, double edge, double spacing) {
  constexpr double kRounding = 1e-9;  // of the number of steps
  const Vector3 half = 0.5 * box.size;
  const double x_end = std::max(0.0, half.x() - edge), y_end = std::max(0.0, half.y() - edge);
  const int x_steps = static_cast<int>(std::floor(2 * x_end / spacing + kRounding)),
            y_steps = static_cast<int>(std::floor(2 * y_end / spacing + kRounding));
  std::vector<Vector3> points;
  for (int i = 0; i <= x_steps; ++i)
    for (int k = 0; k <= y_steps; ++k)
      points.push_back(box.T_world_box *
                       Vector3(-x_end + i * spacing, -y_end + k * spacing, half.z()));
  return points;
}

}  // namespace handsel::manipulation_planner
