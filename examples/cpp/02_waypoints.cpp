// SPDX-License-Identifier: Apache-2.0
// Passes waypoints without stopping, and checks the limits on the exact extremes.
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  const handsel::KinematicLimits limits{Eigen::Vector2d(1, 1), Eigen::Vector2d(2, 2),
                                        Eigen::Vector2d(10, 10)};
  const std::vector<Eigen::VectorXd> waypoints{Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0),
                                               Eigen::Vector2d(1, 1), Eigen::Vector2d(2, 1)};
  handsel::SmoothSettings settings;
  settings.allowed_excess = 0;  // every limit holds in the blends too
  const handsel::SmoothResult path = handsel::smooth(waypoints, limits, settings);
  if (!path.ok()) {
    std::printf("no trajectory: %s\n", path.reason.c_str());
    return 1;
  }
  std::printf("with stops: %.4f s\n", path.duration_ptp);
  std::printf("blended: %.4f s\n", path.trajectory.duration());
  for (const handsel::BlendReport& blend : path.corners)
    std::printf("waypoint %d: %s saves %.3f s\n", blend.node, handsel::name(blend.method),
                blend.saved);
  const std::string fault = handsel::why_not_within(path.trajectory, limits, 1e-6);
  std::printf("%s\n", fault.empty() ? "within the limits" : fault.c_str());
  return fault.empty() ? 0 : 1;
}
