// SPDX-License-Identifier: Apache-2.0
// Whether a process is alive, starved or hung, found from its heartbeats and from the kernel's
// accounts of it. Pure: no clock, no files.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace handsel {

enum class Life : std::uint8_t {
  starting,  ///< no heartbeat since its start yet
  alive,
  starved,  ///< no heartbeat, because the process or its listener got no processor
  hung      ///< it does not recover by itself
};

struct LivenessSettings {
  Duration hung_after{from_seconds(2.0)};         ///< without a heartbeat
  Duration silent_job_after{from_seconds(10.0)};  ///< with a job that gives no sign of life
  Duration start_timeout{from_seconds(20.0)};     ///< until the first heartbeat
};

/// What is known of a process at one moment. Delays grow from any origin; only their growth counts.
struct LifeSigns {
  TimePoint now{};  ///< time at which all of these were read, monotonic
  /// Of /proc/PID/stat: R runs or would, S waits, D waits for a device, T stopped, t traced by a
  /// debugger, Z ended.
  char state{'S'};
  Duration main_delay{};  ///< how long its main thread has waited for a processor since its start
  /// The same summed over steps: in each, the max over threads.
  Duration total_delay{};
  Duration own_delay{};  ///< how long the listener for heartbeats could not listen
};

/// Time in which the process or the listener waited for a processor does not count against the
/// process. That a process is stopped is seen without listening: all of that time counts.
class Liveness {
 public:
  /// The process was started at `signs.now`.
  Liveness(const LivenessSettings& settings, const LifeSigns& signs)
      : settings_(settings), last_(signs) {}

  /// A heartbeat arrived; `job_silent`: it says that a job gives no sign of life.
  void beat(TimePoint at, bool job_silent);
  /// Returns the state of the process at `signs.now`, which must not decrease between calls.
  Life assess(const LifeSigns& signs);
  /// Returns the result of the last evaluation: heartbeats come, but a job is hung.
  bool job_hung() const { return job_hung_; }

 private:
  LivenessSettings settings_;
  LifeSigns last_;                      // at the last heartbeat, or at the start
  std::optional<LifeSigns> job_since_;  // when the job was first found silent
  std::optional<TimePoint> new_beat_;   // since the last evaluation
  std::optional<TimePoint> stopped_since_;
  bool beaten_{}, job_silent_{}, job_hung_{};
};

/// How long to wait before a process is started again: doubled with each death, from the first
/// value on after a stable life.
struct BackoffSettings {
  Duration first{from_seconds(0.1)};          ///< wait after a first death
  Duration max_wait{from_seconds(10.0)};      ///< upper limit of the wait
  Duration stable_after{from_seconds(30.0)};  ///< a life this long forgets the deaths before
};

class Backoff {
 public:
  explicit Backoff(const BackoffSettings& settings) : settings_(settings), next_(settings.first) {}
  /// A process that lived so long has ended: how long to wait.
  Duration after_life_of(Duration lived);

 private:
  BackoffSettings settings_;
  Duration next_;
};

}  // namespace handsel
