// SPDX-License-Identifier: Apache-2.0
// What `handsel status` shows, computed from the samples received.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "deploy/handsel/system/observer.hpp"

namespace handsel {

/// One process of the list.
struct ProcessLine {
  std::string component;  ///< name, as ComponentHealth has it
  /// Ok, degraded, starting, stopping, silent (no health for longer than the lease), missing (no
  /// health ever), restarting (does not run; `reason` says how it ended, how often that was so and
  /// when it is started again).
  std::string state;
  std::string reason;  ///< of the state, as the component reports; may be empty
  double rate{};       ///< samples received, all topics [Hz]
  std::uint64_t deadline_misses{}, rejected{};  ///< sums over all topics
  std::uint64_t refused{};              ///< samples of second writers, all topics with one writer
  std::string second_writers;           ///< "TOPIC: NAME" of each there is now, separated by commas
  double memory_mb{}, cpu{}, uptime{};  ///< [MB], ratio of one core, [s]
  std::uint32_t pid{};                  ///< 0: it does not run, or nothing is known of it
};

struct SystemStatus {
  std::vector<ProcessLine> processes;  ///< in the order of kProcesses, then others with health
  /// "component: what and why: count", of everything quotas have left out.
  std::vector<std::string> left_out;
  /// One sentence each, naming the process or the cause; empty: all well.
  std::vector<std::string> troubles;
};

/// A component is silent when its health is older than this; health comes at 5 Hz.
inline constexpr Duration kSilent = std::chrono::milliseconds(600);

/// Returns the process at the robot's end: "driver" when its health has come and the simulator's
/// has not, else "sim".
std::string robot_side(const Snapshot&);
/// Returns the status at `now` (clock of the bus): processes, samples left out, troubles.
SystemStatus make_status(const Snapshot&, TimePoint now);
/// Returns the object that `handsel status` prints as JSON.
nlohmann::json to_json(const SystemStatus&, const Snapshot&, TimePoint now);
/// Returns the table for people, each trouble on a line of its own with "! ".
std::string to_text(const SystemStatus&, const Snapshot&, TimePoint now);

}  // namespace handsel
