// SPDX-License-Identifier: Apache-2.0
// Number of voluntary context switches of the calling thread.
#pragma once

#include <sys/resource.h>

namespace handsel::test {

/// Returns the number of times that the calling thread has given up the processor by itself, since
/// the thread began.
inline long voluntary_switches() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

}  // namespace handsel::test
