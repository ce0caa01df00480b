// SPDX-License-Identifier: Apache-2.0
// Random numbers for tests of motions.
#pragma once

#include <cstdlib>
#include <random>

#include "common/trajectory/trajectory.hpp"

namespace handsel::test {

struct Draw {
  std::mt19937_64 random;
  double operator()(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  }
  Eigen::VectorXd vector(int n, double lo, double hi) {
    Eigen::VectorXd v(n);
    for (double& x : v) x = (*this)(lo, hi);
    return v;
  }
  KinematicLimits limits(int n) { return {vector(n, 0.3, 2), vector(n, 0.6, 4), vector(n, 2, 16)}; }
};

inline KinematicLimits scaled(const KinematicLimits& l, double k) {
  return {l.velocity * k, l.acceleration * k, l.jerk * k};
}

/// Random runs of a property test: few in the suite, as many as HANDSEL_RUNS says on demand.
inline int runs(int in_suite) {
  return std::getenv("HANDSEL_RUNS") ? std::atoi(std::getenv("HANDSEL_RUNS")) : in_suite;
}

}  // namespace handsel::test
