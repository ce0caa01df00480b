// SPDX-License-Identifier: Apache-2.0
// A component's time when the simulator gives the pace. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace handsel {

/// How far components may let their time advance.
struct TimeGrant {
  std::uint64_t incarnation{};  ///< random number of the simulator, new at each of its starts
  TimePoint until{};            ///< instant of simulated time that no component's time passes
  Duration waited{};            ///< total time the clock was halted since the simulator started
};

/// The machine's monotonic clock ("wall") less the total halt. Time halts where no more is granted,
/// goes back only at the first grant, and is the machine's clock until then. A grant that ended
/// more than 50 ms ago lets time advance no further: a process that was stopped meanwhile first
/// learns whether the simulator has waited for it. When the simulator has been silent for a second
/// in which this component was able to receive a grant, time continues from its current value.
class PacedClock {
 public:
  /// Applies a grant; returns false and ignores the grant when another simulator has sent one
  /// within the last second.
  bool grant(const TimeGrant& grant, TimePoint wall);
  /// Returns the time at `wall`; results never decrease after the first grant.
  TimePoint at(TimePoint wall);
  /// Converts an earlier `wall`, e.g. an arrival, to this clock's time, at most the last at().
  /// Exact back to the arrival of the grant before the newest.
  TimePoint past(TimePoint wall) const;
  /// Returns whether the newest grant ended more than 50 ms before `wall`: at() has stopped, and
  /// how far time has advanced is not known.
  bool stale(TimePoint wall) const;
  /// Returns the wall time at which to check for `instant` again: when it is reached, or 20 ms
  /// after `wall` while it is not granted.
  TimePoint look_at(TimePoint instant, TimePoint wall) const;
  /// Returns whether a simulator gives the time; false before its first grant and after a second of
  /// its silence.
  bool paced() const { return paced_; }

 private:
  TimePoint unbounded(TimePoint wall) const { return wall - waited_; }

  bool paced_{false}, ever_paced_{false};
  std::uint64_t incarnation_{};
  TimePoint until_{}, last_{};
  Duration waited_{};
  TimePoint until_before_{TimePoint::min()};  // of the grant before
  Duration waited_before_{};
  Duration silence_{};  // of the simulator, while this component listened
  TimePoint listened_{};
};

}  // namespace handsel
