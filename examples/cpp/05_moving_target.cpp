// SPDX-License-Identifier: Apache-2.0
// Meets another trajectory that runs already, in motion and as early as possible.
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  const handsel::KinematicLimits limits{Eigen::VectorXd::Constant(1, 1),
                                        Eigen::VectorXd::Constant(1, 2),
                                        Eigen::VectorXd::Constant(1, 10)};
  const handsel::KinematicLimits slow{limits.velocity / 4, limits.acceleration, limits.jerk};
  const handsel::MotionState3 start = handsel::rest_state(Eigen::VectorXd::Constant(1, 0.2));
  const auto target =
      handsel::solve(start, handsel::rest_state(Eigen::VectorXd::Constant(1, 2)), slow);
  handsel::SwitchSettings settings;
  settings.on_clock = true;
  const handsel::Switched met = handsel::switch_to(handsel::rest_state(Eigen::VectorXd::Zero(1)),
                                                   target.trajectory, limits, settings);
  if (!met.ok()) {
    std::printf("not met: %s\n", met.reason.c_str());
    return 1;
  }
  const double t = met.connecting;
  const double error = met.trajectory.at(t).position[0] - target.trajectory.at(t).position[0];
  std::printf("met after %.3f s, error %.6f rad\n", t, error < 0 ? -error : error);
  return 0;
}
