// SPDX-License-Identifier: Apache-2.0
// The one thread a component's callbacks run on: timers, wake-ups from other threads, jobs on a
// worker thread. Its time is the monotonic clock, or what the simulator grants (paced_clock.hpp).
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
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/paced_clock.hpp"

namespace handsel {

/// Returns the time on CLOCK_MONOTONIC.
TimePoint monotonic_now();

/// Event loop of one thread, with timers, and a worker thread for jobs. With simulated time the
/// simulator grants the time up to which timers are served.
class Executor {
 public:
  using Log = std::function<void(const std::string&)>;
  explicit Executor(Log log);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Returns the time of the callbacks. With simulated time, in the callback of a timer: the time
  /// at which the timer was due, so that a process that is scheduled late computes the same.
  TimePoint now();
  /// Converts a past time of CLOCK_MONOTONIC to the time of the executor.
  TimePoint past(TimePoint monotonic) { return clock_.past(monotonic); }
  /// Returns whether no new grant of time has arrived for too long: the simulator does not answer.
  bool stale() const { return clock_.stale(monotonic_now()); }
  /// Takes a grant of time; returns whether it was accepted (PacedClock::grant()). The first one
  /// replaces CLOCK_MONOTONIC by the time of the simulator; timers keep the time that is left.
  bool grant(const TimeGrant& grant);

  /// As Bus::every(). Throws std::invalid_argument unless the period is > 0.
  const TimerStatus& every(Duration period, std::function<void(TimePoint)> on_tick);
  /// As every(), but on CLOCK_MONOTONIC also with simulated time; the callback receives the time of
  /// that clock.
  void every_real(Duration period, std::function<void(TimePoint)> on_tick);
  /// As Bus::after(); a delay below 1 ns counts as 1 ns.
  void after(Duration delay, std::function<void(TimePoint)> on_time);
  /// As Bus::run_job(), on a worker thread at normal priority; the time that `work` returns is not
  /// used. After end_jobs() new jobs are dropped and `done` is not called.
  CancelToken run_job(std::function<Duration(const CancelToken&)> work, std::function<void()> done);

  /// Sets the function that the executor calls after wake(). To be set at most once, before run().
  void on_wake(std::function<void()> drain) { drain_ = std::move(drain); }
  /// Makes the executor call the function of on_wake() and finish jobs. Any thread; wake-ups
  /// that are pending at the same time lead to one call.
  void wake() noexcept;
  /// As wake(), but lets the executor sleep: the function is called before the next callback. Any
  /// thread.
  void remind() noexcept { reminded_.store(true, std::memory_order_release); }

  /// Serves callbacks on the calling thread until stop().
  void run();
  /// Serves callbacks until `done` holds (checked before each round of the event loop) or the real
  /// time `limit` is over or stop() was called; returns whether it held.
  bool run_until(const std::function<bool()>& done, Duration limit);
  /// Ends run() and run_until() after the current round of the event loop. Any thread, or a signal
  /// handler.
  void stop() noexcept;
  /// Cancels all jobs, drops those that wait, and waits for the running one; false if it is still
  /// at work after `limit`.
  bool end_jobs(Duration limit);

  /// Returns whether the running job has not called CancelToken::cancelled() for two seconds of its
  /// own processor time, or for ten seconds of real time. (A busy machine gives a job little of its
  /// processors.) To be asked regularly: the count of calls is compared with that of the last time.
  /// `now`: monotonic.
  bool job_silent(TimePoint now);

 private:
  struct Timer;
  using Timers = std::list<std::unique_ptr<Timer>>;
  struct Job {
    std::function<Duration(const CancelToken&)> work;
    std::function<void()> done;
    CancelToken token;
  };
  void turn(int timeout_ms);
  /// Calls the function of on_wake() if remind() has been called.
  void serve_reminder();
  /// Serves every timer that is due, the earliest first.
  void serve_timers();
  /// Returns the earliest of the timers that are due, on the monotonic clock at `wall`, on the time
  /// of the executor at `time`; the end without one.
  Timers::iterator next_due(TimePoint wall, TimePoint time);
  void serve(Timer& timer, TimePoint time);
  /// Sets the descriptor of the timers to the earliest.
  void arm();
  Timer& add_timer(TimePoint now, Duration period, Duration first,
                   std::function<void(TimePoint)> on_tick);
  void work_loop();
  void finish_jobs();

  Log log_;
  cpu_set_t processors_{};  // allowed at construction
  int epoll_{-1};
  int wake_fd_{-1};
  int timer_fd_{-1};
  TimePoint armed_{};  // what timer_fd_ is set to
  std::atomic<bool> woken_{false};
  std::atomic<bool> reminded_{false};
  std::atomic<bool> stop_{false};
  std::function<void()> drain_;
  Timers timers_;
  PacedClock clock_;
  TimePoint last_{};              // now() at the last call
  std::optional<TimePoint> due_;  // of the timer that is served with granted time

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
  Duration seen_used_{};  // processor time of worker_ at seen_at_
};

}  // namespace handsel
