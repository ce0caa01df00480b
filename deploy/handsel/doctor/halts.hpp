// SPDX-License-Identifier: Apache-2.0
// Stamps of a simulated system against this machine's clock. Pure.
#pragma once

#include <vector>

#include "common/messages/system.hpp"

namespace handsel {

/// Time for which the simulator has halted the system's time: stamps of its measurements lag behind
/// this machine's clock by as much. Zero while no simulator gives the time.
class SimulatorHalts {
 public:
  /// Records an announcement of the simulator that came at `arrival`, not earlier than the one
  /// before.
  void announced(const SimClock& clock, TimePoint arrival) {
    const Duration total = from_seconds(clock.waited);
    if (totals_.empty() || totals_.back().waited != total) totals_.push_back({arrival, total});
  }
  /// Returns the total halt that was in force for a message that came at `arrival`.
  Duration at(TimePoint arrival) const {
    Duration waited{};
    for (const Total& total : totals_) {
      if (total.since > arrival && &total != &totals_.front()) break;
      waited = total.waited;
    }
    return waited;
  }

 private:
  struct Total {
    TimePoint since{};
    Duration waited{};
  };
  std::vector<Total> totals_;
};

}  // namespace handsel
