// SPDX-License-Identifier: Apache-2.0
// Time as the cores see it: instants of a monotonic clock that is handed in, never read.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace handsel {

using Duration = std::chrono::nanoseconds;

/// The clock of every age and deadline: CLOCK_MONOTONIC on DdsBus, virtual time on LocalBus.
/// Deliberately without now(): a core is given the time.
struct MonotonicClock {
  using duration = Duration;
  using rep = Duration::rep;
  using period = Duration::period;
  using time_point = std::chrono::time_point<MonotonicClock, Duration>;
  /// Requirement of a standard clock: the time never decreases.
  static constexpr bool is_steady = true;
};
using TimePoint = MonotonicClock::time_point;

/// Nanoseconds of the system clock (UTC), for people and logs only; 0 means unknown.
using Stamp = std::int64_t;

/// Returns the duration in seconds [s].
constexpr double to_seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }
/// Converts from seconds, rounded to the nearest nanosecond.
inline Duration from_seconds(double s) { return Duration(std::llround(s * 1e9)); }

}  // namespace handsel
