// SPDX-License-Identifier: Apache-2.0
// Preloaded library: the wall clock of every forked process jumps ahead by one second 0.5 s after
// its fork; the monotonic clock does not.
#include <dlfcn.h>
#include <pthread.h>
#include <time.h>

namespace {

using Function = int (*)(clockid_t, timespec*);

Function real() {
  static const auto function = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "clock_gettime"));
  return function;
}

timespec forked{};

void begin() { real()(CLOCK_MONOTONIC, &forked); }

__attribute__((constructor)) void prepare() { pthread_atfork(nullptr, nullptr, &begin); }

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* t) {
  const int result = real()(clock, t);
  if (clock != CLOCK_REALTIME || forked.tv_sec == 0) return result;
  timespec now{};
  real()(CLOCK_MONOTONIC, &now);
  const double since = static_cast<double>(now.tv_sec - forked.tv_sec) +
                       static_cast<double>(now.tv_nsec - forked.tv_nsec) * 1e-9;
  if (since > 0.5) t->tv_sec += 1;
  return result;
}
