// SPDX-License-Identifier: Apache-2.0
// Moves two axes from rest to rest in minimum time, both ending together.
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  const handsel::KinematicLimits limits{Eigen::Vector2d(1, 1), Eigen::Vector2d(1, 1),
                                        Eigen::Vector2d(5, 5)};
  const handsel::MotionState3 from = handsel::rest_state(Eigen::Vector2d(0, 0)),
                              to = handsel::rest_state(Eigen::Vector2d(1, -0.5));
  const handsel::Solution solution = handsel::solve(from, to, limits);
  if (!solution.ok()) {
    std::printf("no trajectory: %s\n", solution.reason.c_str());
    return 1;
  }
  std::printf("duration %.4f s\n", solution.trajectory.duration());
  for (double t = 0; t <= solution.trajectory.duration(); t += 0.5) {
    const handsel::MotionState3 at = solution.trajectory.at(t);
    std::printf("%.1f s: %6.3f %6.3f rad, %6.3f %6.3f rad/s\n", t, at.position[0], at.position[1],
                at.velocity[0], at.velocity[1]);
  }
  const handsel::MotionState3 end = handsel::final_state(solution.trajectory);
  std::printf("at the end: %.3f %.3f\n", end.position[0], end.position[1]);
  return 0;
}
