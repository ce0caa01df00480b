// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/cartesian/path_check.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_planner {

bool held_upright(const std::optional<HeldLevel>& held, const Pose& T) {
  if (!held) return true;
  const HeldLevel& level = *held;
  const double c = (T.linear() * level.axis_tool.normalized()).dot(level.up_root.normalized());
  return std::acos(std::clamp(c, -1.0, 1.0)) <= level.bound;
}

std::size_t first_touching(CollisionWorld& world, const std::vector<Vector>& configurations,
                           double step) {
  struct Run {
    std::size_t begin, end;
  };
  std::vector<Run> runs;
  std::vector<Vector> low, high;
  const auto check = [&]() -> std::optional<std::size_t> {
    const int count = static_cast<int>(runs.size());
    const std::uint32_t unclear =
        count > 0 ? world.unclear_boxes(low.data(), high.data(), count) : 0;
    for (int i = 0; i < count; ++i) {
      const Run& run = runs[static_cast<std::size_t>(i)];
      if ((unclear >> i & 1) == 0) continue;
      for (const std::size_t k : {run.begin, run.end})
        if (!world.is_free(configurations[k])) return k;
    }
    runs.clear();
    low.clear();
    high.clear();
    return std::nullopt;
  };
  for (std::size_t begin = 0; begin < configurations.size();) {
    Vector lower_bound = configurations[begin], upper_bound = lower_bound;
    std::size_t end = begin;
    while (end + 1 < configurations.size()) {
      const Vector lower = lower_bound.cwiseMin(configurations[end + 1]),
                   upper = upper_bound.cwiseMax(configurations[end + 1]);
      if (end > begin && (upper - lower).maxCoeff() > step) break;
      lower_bound = lower;
      upper_bound = upper;
      ++end;
    }
    runs.push_back({begin, end});
    low.push_back(lower_bound);
    high.push_back(upper_bound);
    begin = end > begin && end + 1 < configurations.size() ? end : configurations.size();
    if (runs.size() < CollisionWorld::kMaxBoxes && begin < configurations.size()) continue;
    if (const auto touching = check()) return *touching;
  }
  return configurations.size();
}

}  // namespace handsel::trajectory_planner
