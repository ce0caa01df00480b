// SPDX-License-Identifier: Apache-2.0
// Processor time of this thread, independent of other processes.
#pragma once

#include <ctime>

namespace handsel::test {

/// [s]
inline double thread_time() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace handsel::test
