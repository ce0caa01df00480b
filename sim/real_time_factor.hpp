// SPDX-License-Identifier: Apache-2.0
// Measures the ratio of simulated time to real time.
#pragma once

#include "common/base/time.hpp"

namespace handsel::sim {

/// Ratio of simulated time to real time, measured over about one second.
class RealTimeFactor {
 public:
  /// Begins a measurement at `now`, when the simulated time is `simulated` [s].
  void restart(TimePoint now, double simulated) {
    from_ = now;
    simulated_from_ = simulated;
  }
  /// Ends a measurement that has lasted a second, and begins the next.
  void update(TimePoint now, double simulated) {
    if (const double passed = to_seconds(now - from_); passed >= 1.0) {
      factor_ = (simulated - simulated_from_) / passed;
      restart(now, simulated);
    }
  }
  /// Returns the result of the last measurement; 1 before the first.
  double value() const { return factor_; }

 private:
  TimePoint from_{};
  double simulated_from_{0}, factor_{1};
};

}  // namespace handsel::sim
