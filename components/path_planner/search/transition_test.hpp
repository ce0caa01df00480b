// SPDX-License-Identifier: Apache-2.0
// The transition test of T-RRT (chapter section 4.1.1): accepts decreasing costs always and
// increasing costs with a probability that falls with the increase. The temperature rises after
// refusals and falls after each accepted increase.
#pragma once

#include <algorithm>
#include <cmath>

#include "components/path_planner/search/random.hpp"

namespace handsel::path_planner {

class TransitionTest {
 public:
  /// Temperature in units of cost.
  TransitionTest(double temperature, Random& random) : temperature_(temperature), random_(random) {}
  bool operator()(double from, double to) {
    if (to <= from) return true;
    if (random_.unit() < std::exp(-(to - from) / temperature_)) {
      temperature_ = std::max(kMinTemperature, temperature_ / kTemperatureFactor);
      refusals_ = 0;
      return true;
    }
    if (++refusals_ > kMaxRefusals) {
      temperature_ *= kTemperatureFactor;
      refusals_ = 0;
    }
    return false;
  }

 private:
  static constexpr double kTemperatureFactor = 1.5;
  static constexpr int kMaxRefusals = 3;
  static constexpr double kMinTemperature = 1e-6;

  double temperature_;
  Random& random_;
  int refusals_{0};
};

}  // namespace handsel::path_planner
