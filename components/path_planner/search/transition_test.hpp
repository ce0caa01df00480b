// SPDX-License-Identifier: Apache-2.0
// The transition test of T-RRT (chapter section 4.1.1): accepts decreasing costs always and
// increasing costs with a probability that falls with the increase. The temperature rises after
// refusals and falls after each accepted increase.
#pragma once

#include <algorithm>
#include <cmath>

#include "components/path_planner/search/random.hpp"

namespace handsel::path_planner {

struct TransitionSettings {
  double temperature{};  ///< initial [unit of cost]
  double factor{};       ///< of a rise and a fall of the temperature
  int max_refusals{};    ///< in a row, after which it rises
};

class TransitionTest {
 public:
  TransitionTest(const TransitionSettings& settings, Random& random)
      : settings_(settings), temperature_(settings.temperature), random_(random) {}
  bool operator()(double from, double to) {
    if (to <= from) return true;
    if (random_.unit() < std::exp(-(to - from) / temperature_)) {
      temperature_ = std::max(kMinTemperature, temperature_ / settings_.factor);
      refusals_ = 0;
      return true;
    }
    if (++refusals_ > settings_.max_refusals) {
      temperature_ *= settings_.factor;
      refusals_ = 0;
    }
    return false;
  }

 private:
  static constexpr double kMinTemperature = 1e-6;

  TransitionSettings settings_;
  double temperature_;
  Random& random_;
  int refusals_{0};
};

}  // namespace handsel::path_planner
