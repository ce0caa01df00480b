// SPDX-License-Identifier: Apache-2.0
// Priority and processor of this process.
#pragma once

#include <string>

namespace handsel {

struct RealtimeSettings {
  int cpu{-1};      ///< Processor that the process runs on; negative: any.
  bool wanted{};    ///< Whether the process runs under SCHED_FIFO with locked memory.
  int priority{1};  ///< Of SCHED_FIFO.
};

/// Sets processor, priority and memory locking of the calling thread and of threads that it makes.
/// Returns what was not asked for or not permitted; empty: all was done. Throws ConfigError when
/// the processor cannot be used.
std::string enter_realtime(const RealtimeSettings& settings);

}  // namespace handsel
