// SPDX-License-Identifier: Apache-2.0
// Stops one axis in minimum time within its limits, step by step as a control cycle does.
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  handsel::JerkLimitedStop stop;
  stop.init({0.0, 0.5, 0.0}, {1.0, 1.0, 5.0});  // at 0.5 rad/s
  double t = 0;
  while (!stop.finished() && t < 10) {
    stop.step(0.001);
    t += 0.001;
  }
  std::printf("at rest after %.4f s at %.4f rad\n", t, stop.state().position);
  return stop.finished() ? 0 : 1;
}
