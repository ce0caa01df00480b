// SPDX-License-Identifier: Apache-2.0
// Finds hung processes by their heartbeats, has them replaced, and reports for processes that
// cannot: the launcher's participant on the bus.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "common/bus/bus.hpp"
#include "common/messages/system.hpp"
#include "deploy/handsel/system/launcher.hpp"
#include "deploy/handsel/system/liveness.hpp"
#include "deploy/handsel/system/proc_stat.hpp"

namespace handsel {

/// Heartbeats are samples of ComponentHealth: they are published on the thread that does a
/// process's work. Checked on the monotonic clock, whatever the time of the system is. While a
/// process does not run, ComponentHealth with its name, state stopping and pid 0 says how it ended,
/// how often it was started again and when it will be.
class ProcessWatch {
 public:
  /// Lives on the executor thread of the bus; the launcher must outlive the deliveries of the bus.
  ProcessWatch(Bus& bus, Launcher& launcher, const LivenessSettings& settings);
  ProcessWatch(const ProcessWatch&) = delete;
  ProcessWatch& operator=(const ProcessWatch&) = delete;

 private:
  struct Watched {
    pid_t pid;
    Liveness liveness;
    char state{'S'};  // LifeSigns::state
    TimePoint last_beat{};
    ThreadDelay threads{};
    Duration total_delay{};
    bool job_silent{};
  };
  void on_health(const ComponentHealth& health);
  void check();
  void assess(const ProcessStatus& process, TimePoint now);
  void speak_for(const ProcessStatus& process);
  void measure_own_delay(TimePoint now);
  bool majority_is_silent(TimePoint now) const;

  Launcher& launcher_;
  LivenessSettings settings_;
  std::unique_ptr<Publisher<ComponentHealth>> out_;
  std::map<std::string, Watched> watched_;  // by process
  ThreadDelay own_threads_;
  Duration own_threads_delay_{}, own_delay_{};
  TimePoint last_check_{};
  std::uint64_t checks_{};
};

}  // namespace handsel
