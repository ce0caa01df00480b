// SPDX-License-Identifier: Apache-2.0
// Tells which processes of this machine that take part in simulated time are running.
#pragma once

#include <cstdint>
#include <map>

#include "common/bus/process_state.hpp"

namespace handsel::sim {

/// Processes by number, and whether the kernel shows them: processes of another container may be
/// invisible.
class KnownProcesses {
 public:
  /// Adds a process unless already added.
  void add(std::uint64_t process) {
    if (!visible_.contains(process)) visible_[process] = state(process) != 'X';
  }
  /// Returns whether a process is neither stopped nor ended, as far as the kernel shows it.
  bool runs(std::uint64_t process) const {
    const auto found = visible_.find(process);
    if (found == visible_.end() || !found->second) return true;
    const char now = state(process);
    return now != 'T' && now != 'Z' && now != 'X';
  }

 private:
  static char state(std::uint64_t process) { return process_state(static_cast<pid_t>(process)); }
  std::map<std::uint64_t, bool> visible_;
};

}  // namespace handsel::sim
