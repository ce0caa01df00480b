// SPDX-License-Identifier: Apache-2.0
// Pauses a running trajectory on its path and resumes it; no limit is exceeded meanwhile.
#include <cmath>
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const handsel::KinematicLimits guard{one, 2 * one, 10 * one};
  const handsel::KinematicLimits planned{guard.velocity / 1.1, guard.acceleration / 1.1,
                                         guard.jerk / 1.1};
  const auto plan = handsel::solve(handsel::rest_state(0 * one), handsel::rest_state(one), planned);
  handsel::TimeScaling run;
  const std::string fault = run.init(plan.trajectory, guard);
  if (!fault.empty()) {
    std::printf("cannot run: %s\n", fault.c_str());
    return 1;
  }
  double max_velocity = 0;
  for (int cycle = 0; !run.finished() && cycle < 10000; ++cycle) {
    if (cycle == 500) run.set_target(0);  // pause
    if (cycle == 3000) {
      std::printf("paused: velocity %.3f rad/s at %.3f rad\n", std::abs(run.state().velocity[0]),
                  run.state().position[0]);
      run.set_target(1);  // resume
    }
    run.advance(0.001);
    max_velocity = std::max(max_velocity, std::abs(run.state().velocity[0]));
  }
  std::printf("finished at %.3f rad, max %.3f rad/s\n", run.state().position[0], max_velocity);
  return run.finished() && max_velocity <= 1 ? 0 : 1;
}
