// SPDX-License-Identifier: Apache-2.0
// For how long a running process has waited for a processor: /proc.
#pragma once

#include <sys/types.h>

#include <map>

#include "common/base/time.hpp"

namespace handsel {

/// Time the main thread has waited for a processor so far; zero if the kernel does not report it.
Duration main_thread_delay(pid_t pid);

/// How long the threads of a process have waited for a processor: in each step the one that waited
/// longest counts.
class ThreadDelay {
 public:
  /// Adds the step since the last call and returns the sum; threads that began since then do not
  /// count yet.
  Duration update(pid_t pid);

 private:
  std::map<pid_t, Duration> before_;
  Duration total_{};
};

}  // namespace handsel
