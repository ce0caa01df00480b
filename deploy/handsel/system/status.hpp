// What `handsel status` shows, computed from what was heard.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "deploy/handsel/system/observer.hpp"

namespace handsel {

/// One process of the list.
struct ProcessLine {
  std::string component;
  std::string state;  ///< ok, degraded, starting, stopping, silent (heard, then not for longer than the lease), missing (never heard),
                      ///< restarting (does not run; `reason` says how it ended, how often that was so and when it is started again)
  std::string reason;
  double rate{};  ///< samples received, all topics [Hz]
  std::uint64_t deadline_misses{}, rejected{};
  std::uint64_t refused{};     ///< samples of second writers, all topics with one writer
  std::string second_writers;  ///< "TOPIC: NAME" of each there is now, separated by commas
  double memory_mb{}, cpu{}, uptime{};
  std::uint32_t pid{};
};

struct SystemStatus {
  std::vector<ProcessLine> processes;  ///< in the order of kProcesses, then others heard
  std::vector<std::string> left_out;   ///< "component: what and why: count", of everything quotas have left out
  std::vector<std::string> troubles;   ///< one sentence each, naming the process or the cause; empty: all well
};

/// A component is silent when not heard for this long; health comes at 5 Hz.
inline constexpr Duration kSilent = std::chrono::milliseconds(600);

/// The process at the robot's end: "driver" when one is heard and the simulator is not, else "sim".
std::string robot_side(const Snapshot&);
SystemStatus make_status(const Snapshot&, TimePoint now);
nlohmann::json to_json(const SystemStatus&, const Snapshot&, TimePoint now);
std::string to_text(const SystemStatus&, const Snapshot&, TimePoint now);

}  // namespace handsel
