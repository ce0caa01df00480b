// SPDX-License-Identifier: Apache-2.0
// Processor time of work in its thread, independent of other processes.
#pragma once

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <vector>

namespace handsel::test {

/// Of this thread [s].
inline double seconds(const std::function<void()>& work) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

class Times {
 public:
  void add(double seconds) { all_.push_back(seconds); }
  /// Returns the quantile `ratio` of the times [ms]; 0 without times.
  double at(double ratio) {
    std::sort(all_.begin(), all_.end());
    return all_.empty()
               ? 0.0
               : all_[static_cast<std::size_t>(ratio * static_cast<double>(all_.size() - 1))] * 1e3;
  }
  void print(const char* what) {
    std::printf("%-24s %4zu cases  median %7.2f  p95 %7.2f  p99 %7.2f  largest %7.2f ms\n", what,
                all_.size(), at(0.5), at(0.95), at(0.99), at(1));
  }

 private:
  std::vector<double> all_;
};

}  // namespace handsel::test
