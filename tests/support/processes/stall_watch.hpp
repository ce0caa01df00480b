// SPDX-License-Identifier: Apache-2.0
// Real-time scenarios on a shared machine: a hypervisor may withhold all processors for tens of
// milliseconds, regardless of priorities. A scenario that fails during such a stall is invalid and
// runs again.
#pragma once

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

#include "common/bus/executor.hpp"

namespace handsel::test {

/// Time that the machine took away: a thread on each processor, more urgent than anything under
/// test, is to wake every half millisecond.
class StallWatch {
 public:
  static constexpr double kTolerated = 0.004;  ///< loss within 20 ms that a story survives [s]

  StallWatch() {
    running_ = this;
    for (unsigned cpu = 0; cpu < std::thread::hardware_concurrency(); ++cpu)
      threads_.emplace_back([this, cpu] { watch(cpu); });
  }
  ~StallWatch() {
    running_ = nullptr;
    end_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

  /// Whether the machine took so much away during the running story that a failure of the story
  /// would say nothing.
  static bool was_away() {
    const StallWatch* const watch = running_;
    return watch != nullptr && watch->worst() > kTolerated;
  }

  /// Waits for the next stall, at most `time`; returns whether one occurred.
  bool stalls_within(Duration time) const {
    std::unique_lock lock(mutex_);
    const std::size_t before = stalls_.size();
    return stalled_.wait_for(lock, time, [&] { return stalls_.size() > before; });
  }

  /// Returns the max time that one processor lost within 20 ms so far [s].
  double worst() const {
    const std::lock_guard lock(mutex_);
    double worst = 0.0;
    for (const Stall& last : stalls_) {
      double lost = 0.0;
      for (const Stall& one : stalls_)
        if (one.cpu == last.cpu && one.over <= last.over &&
            one.over > last.over - std::chrono::milliseconds(20))
          lost += one.length;
      worst = std::max(worst, lost);
    }
    return worst;
  }

 private:
  static constexpr Duration kPeriod = std::chrono::microseconds(500);
  static constexpr Duration kPunctual = std::chrono::milliseconds(1);
  struct Stall {
    TimePoint over{};
    double length{};  // [s]
    unsigned cpu{};
  };

  static void wait_until(TimePoint time) {
    const auto ns = time.time_since_epoch().count();
    const timespec at{ns / 1'000'000'000, ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
  }
  void watch(unsigned cpu) {
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(cpu, &only);
    pthread_setaffinity_np(pthread_self(), sizeof only, &only);
    const sched_param urgent{90};
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &urgent);
    for (TimePoint next = monotonic_now() + kPeriod; !end_; next += kPeriod) {
      wait_until(next);
      const TimePoint now = monotonic_now();
      if (now - next < kPunctual) continue;
      const std::lock_guard lock(mutex_);
      stalls_.push_back({now, to_seconds(now - next), cpu});
      stalled_.notify_all();
      next = now;
    }
  }

  static inline const StallWatch* running_ = nullptr;  // read only by the thread of the scenario
  mutable std::mutex mutex_;
  mutable std::condition_variable stalled_;
  std::vector<Stall> stalls_;
  std::atomic<bool> end_{false};
  std::vector<std::thread> threads_;
};

/// Waits for a second without a stall, at most 20 s: stalls come in bursts.
inline void await_quiet_machine() {
  const StallWatch watch;
  const TimePoint deadline = monotonic_now() + std::chrono::seconds(20);
  while (watch.stalls_within(std::chrono::seconds(1)) && monotonic_now() < deadline) {
  }
}

/// Runs `story` repeatedly. Failures count if no stall occurred, and in the last attempt always;
/// `afresh` runs before each attempt but the first, once the machine is quiet.
template <class Story, class Afresh>
void in_real_time(const Story& story, const Afresh& afresh) {
  constexpr int kTellings = 12;
  for (int telling = 1;; ++telling) {
    testing::TestPartResultArray results;
    double lost = 0.0;
    {
      const testing::ScopedFakeTestPartResultReporter kept(
          testing::ScopedFakeTestPartResultReporter::INTERCEPT_ALL_THREADS, &results);
      const StallWatch watch;
      story();
      lost = watch.worst();
    }
    bool failed = false;
    for (int i = 0; i < results.size(); ++i)
      failed = failed || results.GetTestPartResult(i).failed();
    if (failed && lost > StallWatch::kTolerated && telling < kTellings) {
      std::printf("void: the machine took %.1f of 20 ms away; %s\n", 1e3 * lost,
                  results.GetTestPartResult(0).message());
      std::fflush(stdout);
      await_quiet_machine();
      afresh();
      continue;
    }
    for (int i = 0; i < results.size(); ++i) {
      const testing::TestPartResult& result = results.GetTestPartResult(i);
      GTEST_MESSAGE_AT_(result.file_name(), result.line_number(), result.message(), result.type());
    }
    return;
  }
}

}  // namespace handsel::test
