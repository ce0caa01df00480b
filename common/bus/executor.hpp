// The one thread a component's callbacks run on: timers on the monotonic clock, wake-ups from other threads, jobs on a worker thread.
#pragma once

#include <sched.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"

namespace handsel {

/// Now on CLOCK_MONOTONIC.
TimePoint monotonic_now();

/// Reason of a degraded process whose job does not ask its token any more.
inline constexpr const char* kSilentJob = "a job has given no sign of life for two seconds";

class Executor {
 public:
  using Log = std::function<void(const std::string&)>;
  explicit Executor(Log log);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  const TimerStatus& every(Duration period, std::function<void(TimePoint)> on_tick);
  void after(Duration delay, std::function<void(TimePoint)> on_time);
  CancelToken run_job(std::function<Duration(const CancelToken&)> work, std::function<void()> done);

  /// Called on the executor after wake(); set once before running.
  void on_wake(std::function<void()> drain) { drain_ = std::move(drain); }
  /// From any thread; wake-ups that come together are one.
  void wake() noexcept;

  void run();
  bool run_until(const std::function<bool()>& done, Duration limit);
  void stop() noexcept;
  /// Cancels all jobs, drops those that wait, and waits for the running one; false if it is still at work after `limit`.
  bool end_jobs(Duration limit);

  /// Empty, or which job has given no sign of life for two seconds.
  std::string silent_job(TimePoint now);

 private:
  struct Timer;
  struct Job {
    std::function<Duration(const CancelToken&)> work;
    std::function<void()> done;
    CancelToken token;
  };
  void turn(int timeout_ms);
  void fire(Timer& timer);
  Timer& add_timer(Duration first, Duration period, std::function<void(TimePoint)> on_tick);
  void work_loop();
  void finish_jobs();

  Log log_;
  cpu_set_t processors_{};  // allowed at construction
  int epoll_{-1};
  int wake_fd_{-1};
  std::atomic<bool> woken_{false};
  std::atomic<bool> stop_{false};
  std::function<void()> drain_;
  std::list<std::unique_ptr<Timer>> timers_;
  std::vector<Timer*> spent_;

  std::thread worker_;
  std::mutex jobs_mutex_;
  std::condition_variable jobs_waiting_, worker_ended_;
  std::deque<Job> queued_, finished_;
  CancelToken running_token_;
  bool running_{false};
  bool worker_ends_{false};
  bool worker_gone_{false};
  std::uint64_t seen_beats_{0};
  TimePoint seen_at_{};
};

}  // namespace handsel
