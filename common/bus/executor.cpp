// SPDX-License-Identifier: Apache-2.0
#include "common/bus/executor.hpp"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "common/base/errors.hpp"

namespace handsel {
namespace {
// Processor time of a job without a sign of life, and real time for a job that waits.
constexpr Duration kJobSilence = std::chrono::seconds(2);
constexpr Duration kJobStandstill = std::chrono::seconds(10);
// Max delay up to which all granted ticks are served. A process that the simulator waits for is
// less late, as the simulator grants only two periods of 10 ms ahead.
constexpr Duration kMaxBurst = std::chrono::milliseconds(40);
// Simulated time: timers are served at multiples of this period. Each tick computes with its due
// time, so the period only reduces the number of wake-ups.
constexpr Duration kServingPeriod = std::chrono::milliseconds(2);

timespec to_timespec(Duration d) {
  return {static_cast<time_t>(d.count() / 1'000'000'000),
          static_cast<long>(d.count() % 1'000'000'000)};
}
}  // namespace

static Duration processor_time(std::thread& thread) {
  clockid_t clock{};
  timespec used{};
  if (!thread.joinable() || pthread_getcpuclockid(thread.native_handle(), &clock) != 0) return {};
  clock_gettime(clock, &used);
  return Duration(used.tv_sec * 1'000'000'000LL + used.tv_nsec);
}

TimePoint monotonic_now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return TimePoint(Duration(t.tv_sec * 1'000'000'000LL + t.tv_nsec));
}

struct Executor::Timer {
  Duration period{};  // 0: once
  TimePoint due{};
  bool real{};  // runs on the monotonic clock
  std::function<void(TimePoint)> on_tick;
  TimerStatus status;
};

Executor::Executor(Log log) : log_(std::move(log)) {
  CPU_ZERO(&processors_);
  sched_getaffinity(0, sizeof processors_, &processors_);
  epoll_ = epoll_create1(EPOLL_CLOEXEC);
  wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  timer_fd_ = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  epoll_event event{};
  event.events = EPOLLIN;
  bool watched = epoll_ >= 0;
  for (const int fd : {wake_fd_, timer_fd_}) {
    event.data.fd = fd;
    watched = watched && fd >= 0 && epoll_ctl(epoll_, EPOLL_CTL_ADD, fd, &event) == 0;
  }
  if (!watched)
    throw MissingError(std::string("executor: no descriptor for the event loop: ") +
                       std::strerror(errno));
}

Executor::~Executor() {
  end_jobs(Duration::max());
  for (const int fd : {timer_fd_, wake_fd_, epoll_})
    if (fd >= 0) close(fd);
}

bool Executor::end_jobs(Duration limit) {
  if (!worker_.joinable()) return true;
  {
    std::unique_lock lock(jobs_mutex_);
    worker_ends_ = true;
    queued_.clear();
    running_token_.cancel();
    jobs_waiting_.notify_all();
    const auto gone = [this] { return worker_gone_; };
    if (limit == Duration::max())
      worker_ended_.wait(lock, gone);
    else if (!worker_ended_.wait_for(lock, limit, gone))
      return false;
    finished_.clear();
  }
  worker_.join();
  return true;
}

TimePoint Executor::now() {
  if (due_) return *due_;
  const TimePoint time = clock_.at(monotonic_now());
  return last_ = clock_.paced() ? std::max(last_, time) : time;
}

bool Executor::grant(const TimeGrant& grant) {
  const TimePoint wall = monotonic_now(), before = clock_.at(wall);
  if (!clock_.grant(grant, wall)) return false;
  const TimePoint after = clock_.at(wall);
  if (after >= before) return true;
  for (const auto& timer :
       timers_)  // at the first grant time goes back; remaining waiting times are unchanged
    if (!timer->real) timer->due -= before - after;
  last_ = after;
  return true;
}

Executor::Timer& Executor::add_timer(TimePoint now, Duration period, Duration first,
                                     std::function<void(TimePoint)> on_tick) {
  auto timer = std::make_unique<Timer>();
  timer->period = period;
  timer->due = now + std::max(first, Duration(1));
  timer->on_tick = std::move(on_tick);
  timers_.push_back(std::move(timer));
  return *timers_.back();
}

const TimerStatus& Executor::every(Duration period, std::function<void(TimePoint)> on_tick) {
  if (period <= Duration::zero()) throw std::invalid_argument("every: the period must be positive");
  return add_timer(now(), period, period, std::move(on_tick)).status;
}

void Executor::every_real(Duration period, std::function<void(TimePoint)> on_tick) {
  add_timer(monotonic_now(), period, period, std::move(on_tick)).real = true;
}

void Executor::after(Duration delay, std::function<void(TimePoint)> on_time) {
  add_timer(now(), Duration::zero(), delay, std::move(on_time));
}

Executor::Timers::iterator Executor::next_due(TimePoint wall, TimePoint time) {
  auto next = timers_.end();
  for (auto timer = timers_.begin(); timer != timers_.end(); ++timer)
    if ((*timer)->due <= ((*timer)->real ? wall : time) &&
        (next == timers_.end() || (*timer)->due < (*next)->due))
      next = timer;
  return next;
}

/// Runs a requested drain; in granted time at the due time of the next timer, so that time does not
/// pass that timer.
void Executor::serve_reminder() {
  if (!drain_ || !reminded_.exchange(false, std::memory_order_acq_rel)) return;
  const TimePoint wall = monotonic_now(), time = clock_.at(wall);
  const auto next = next_due(wall, time);
  if (clock_.paced() && next != timers_.end() && !(*next)->real)
    due_ = last_ = std::max(last_, (*next)->due);
  drain_();
  due_.reset();
}

void Executor::serve_timers() {
  const TimePoint wall = monotonic_now();
  const bool paced = clock_.paced();
  const TimePoint time = clock_.at(wall);
  if (paced && !clock_.paced())
    return wake();  // samples received meanwhile are processed before time continues
  while (true) {
    const auto next = next_due(wall, time);
    if (next == timers_.end()) return;
    const bool once = (*next)->period == Duration::zero();
    serve(**next, time);
    if (once) timers_.erase(next);
  }
}

/// Serves a timer. In granted time every missed tick is served at its due time. After a jump of
/// time, when the simulator did not wait for this process, only the latest tick is served: the
/// older ones are obsolete.
void Executor::serve(Timer& timer, TimePoint time) {
  const bool granted = clock_.paced() && !timer.real;
  const TimePoint present = timer.real ? monotonic_now() : granted ? time : this->now();
  const Duration late = present - timer.due;
  const bool made_up = granted && late < kMaxBurst;
  const std::int64_t skipped =
      made_up || timer.period == Duration::zero() ? 0 : late / timer.period;
  if (granted) due_ = last_ = std::max(last_, timer.due + timer.period * skipped);
  if (timer.period > Duration::zero()) {
    ++timer.status.cycles;
    timer.status.late_cycles += !made_up && late > timer.period;
    timer.status.skipped += static_cast<std::uint64_t>(skipped);
    if (!made_up) timer.status.worst = std::max(timer.status.worst, late);
    timer.due += timer.period * (skipped + 1);
  }
  timer.on_tick(granted ? *due_ : present);
  due_.reset();
}

void Executor::arm() {
  if (timers_.empty()) return;
  const TimePoint wall = monotonic_now();
  TimePoint first = TimePoint::max();
  for (const auto& timer : timers_)
    first = std::min(first, timer->real ? timer->due : clock_.look_at(timer->due, wall));
  if (clock_.paced() && first != TimePoint::max())
    first += (kServingPeriod - first.time_since_epoch() % kServingPeriod) % kServingPeriod;
  if (first == armed_) return;
  const itimerspec spec{{}, to_timespec(std::max(first.time_since_epoch(), Duration(1)))};
  timerfd_settime(timer_fd_, TFD_TIMER_ABSTIME, &spec, nullptr);
  armed_ = first;
}

void Executor::wake() noexcept {
  if (woken_.exchange(true, std::memory_order_acq_rel)) return;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_fd_, &one, sizeof one);
}

void Executor::stop() noexcept {
  stop_.store(true, std::memory_order_release);
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_fd_, &one, sizeof one);
}

void Executor::turn(int timeout_ms) {
  arm();
  epoll_event events[2];
  const int n = epoll_wait(epoll_, events, 2, timeout_ms);
  bool woken = false;
  for (int i = 0; i < n; ++i) {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got = read(events[i].data.fd, &count, sizeof count);
    if (events[i].data.fd == wake_fd_)
      woken = true;
    else
      armed_ = {};
  }
  serve_reminder();
  serve_timers();
  if (!woken) return;
  woken_.store(false, std::memory_order_release);
  if (drain_) drain_();
  finish_jobs();
}

void Executor::run() {
  while (!stop_.load(std::memory_order_acquire)) turn(-1);
}

bool Executor::run_until(const std::function<bool()>& done, Duration limit) {
  const TimePoint end = monotonic_now() + limit;
  while (!done()) {
    const Duration left = end - monotonic_now();
    if (left <= Duration::zero() || stop_.load(std::memory_order_acquire)) return false;
    turn(static_cast<int>(std::min<std::int64_t>(left / std::chrono::milliseconds(1) + 1, 1000)));
  }
  return true;
}

CancelToken Executor::run_job(std::function<Duration(const CancelToken&)> work,
                              std::function<void()> done) {
  CancelToken token;
  {
    const std::lock_guard lock(jobs_mutex_);
    if (worker_ends_) return token;
    queued_.push_back({std::move(work), std::move(done), token});
    if (!worker_.joinable()) worker_ = std::thread([this] { work_loop(); });
  }
  jobs_waiting_.notify_one();
  return token;
}

void Executor::work_loop() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  // Jobs run at normal priority on any processor, independent of the executor's settings.
  const sched_param normal{};
  sched_setscheduler(0, SCHED_OTHER, &normal);
  sched_setaffinity(0, sizeof processors_, &processors_);
  std::unique_lock lock(jobs_mutex_);
  while (true) {
    jobs_waiting_.wait(lock, [this] { return worker_ends_ || !queued_.empty(); });
    if (worker_ends_) {
      worker_gone_ = true;
      worker_ended_.notify_all();
      return;
    }
    Job job = std::move(queued_.front());
    queued_.pop_front();
    running_token_ = job.token;
    running_ = true;
    lock.unlock();
    if (!job.token.cancelled()) {
      try {
        job.work(job.token);
      } catch (const std::exception& e) {
        log_(std::string("a job failed: ") + e.what());
      }
    }
    lock.lock();
    running_ = false;
    finished_.push_back(std::move(job));
    wake();
  }
}

void Executor::finish_jobs() {
  std::deque<Job> finished;
  {
    const std::lock_guard lock(jobs_mutex_);
    finished.swap(finished_);
  }
  for (Job& job : finished) job.done();
}

bool Executor::job_silent(TimePoint now) {
  const std::lock_guard lock(jobs_mutex_);
  const std::uint64_t beats = running_token_.beats();
  if (!running_ || beats != seen_beats_) {
    seen_beats_ = beats;
    seen_at_ = now;
    seen_used_ = running_ ? processor_time(worker_) : Duration{};
    return false;
  }
  return processor_time(worker_) - seen_used_ > kJobSilence || now - seen_at_ > kJobStandstill;
}

}  // namespace handsel
