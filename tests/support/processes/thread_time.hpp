// How long this thread has been computing: what other processes do does not count.
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
