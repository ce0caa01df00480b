// SPDX-License-Identifier: Apache-2.0
// Moves in exactly the time asked for; a time that is too short is refused with a reason.
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  const handsel::KinematicLimits limits{Eigen::Vector2d(1, 1), Eigen::Vector2d(1, 1),
                                        Eigen::Vector2d(5, 5)};
  handsel::MotionState3 from = handsel::rest_state(Eigen::Vector2d(0, 0));
  from.velocity[1] = 0.4;  // one axis moves already
  const handsel::MotionState3 to = handsel::rest_state(Eigen::Vector2d(1, 1));
  const auto slow = handsel::solve(from, to, limits, handsel::Sync::time, 5.0);
  if (!slow.ok()) return 1;
  std::printf("exactly %.4f s\n", slow.trajectory.duration());
  const auto fast = handsel::solve(from, to, limits, handsel::Sync::time, 0.5);
  std::printf("refused: %s\n", fast.reason.c_str());
  return fast.ok() ? 1 : 0;
}
