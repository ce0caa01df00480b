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
constexpr Duration kJobSilence = std::chrono::seconds(2);

timespec to_timespec(Duration d) { return {static_cast<time_t>(d.count() / 1'000'000'000), static_cast<long>(d.count() % 1'000'000'000)}; }
}  // namespace

TimePoint monotonic_now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return TimePoint(Duration(t.tv_sec * 1'000'000'000LL + t.tv_nsec));
}

struct Executor::Timer {
  int fd{-1};
  Duration period{};  // 0: once
  TimePoint due{};
  std::function<void(TimePoint)> on_tick;
  TimerStatus status;
  ~Timer() {
    if (fd >= 0) close(fd);
  }
};

Executor::Executor(Log log) : log_(std::move(log)) {
  CPU_ZERO(&processors_);
  sched_getaffinity(0, sizeof processors_, &processors_);
  epoll_ = epoll_create1(EPOLL_CLOEXEC);
  wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.ptr = nullptr;
  if (epoll_ < 0 || wake_fd_ < 0 || epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_fd_, &event) != 0)
    throw MissingError(std::string("executor: no descriptor for the event loop: ") + std::strerror(errno));
}

Executor::~Executor() {
  end_jobs(Duration::max());
  timers_.clear();
  if (wake_fd_ >= 0) close(wake_fd_);
  if (epoll_ >= 0) close(epoll_);
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

Executor::Timer& Executor::add_timer(Duration first, Duration period, std::function<void(TimePoint)> on_tick) {
  auto timer = std::make_unique<Timer>();
  timer->fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  timer->period = period;
  timer->due = monotonic_now() + std::max(first, Duration(1));
  timer->on_tick = std::move(on_tick);
  itimerspec spec{to_timespec(period), to_timespec(timer->due.time_since_epoch())};
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.ptr = timer.get();
  if (timer->fd < 0 || timerfd_settime(timer->fd, TFD_TIMER_ABSTIME, &spec, nullptr) != 0 ||
      epoll_ctl(epoll_, EPOLL_CTL_ADD, timer->fd, &event) != 0)
    throw MissingError(std::string("executor: no descriptor for a timer: ") + std::strerror(errno));
  timers_.push_back(std::move(timer));
  return *timers_.back();
}

const TimerStatus& Executor::every(Duration period, std::function<void(TimePoint)> on_tick) {
  if (period <= Duration::zero()) throw std::invalid_argument("every: the period must be positive");
  return add_timer(period, period, std::move(on_tick)).status;
}

void Executor::after(Duration delay, std::function<void(TimePoint)> on_time) { add_timer(delay, Duration::zero(), std::move(on_time)); }

void Executor::fire(Timer& timer) {
  std::uint64_t expirations = 0;
  if (read(timer.fd, &expirations, sizeof expirations) != sizeof expirations || expirations == 0) return;
  const TimePoint now = monotonic_now();
  if (timer.period == Duration::zero()) {
    spent_.push_back(&timer);
    timer.on_tick(now);
    return;
  }
  const Duration late = now - timer.due;
  ++timer.status.cycles;
  timer.status.late_cycles += late > timer.period;
  timer.status.skipped += expirations - 1;
  timer.status.worst = std::max(timer.status.worst, late);
  timer.due += timer.period * static_cast<std::int64_t>(expirations);
  timer.on_tick(now);
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
  epoll_event events[16];
  const int n = epoll_wait(epoll_, events, 16, timeout_ms);
  bool woken = false;
  for (int i = 0; i < n; ++i) {
    if (events[i].data.ptr)
      fire(*static_cast<Timer*>(events[i].data.ptr));
    else
      woken = true;
  }
  for (const Timer* spent : spent_) timers_.remove_if([spent](const std::unique_ptr<Timer>& t) { return t.get() == spent; });
  spent_.clear();
  if (!woken) return;
  std::uint64_t count = 0;
  [[maybe_unused]] const auto got = read(wake_fd_, &count, sizeof count);
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

CancelToken Executor::run_job(std::function<Duration(const CancelToken&)> work, std::function<void()> done) {
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
  // Jobs run at normal priority on any processor, however the executor does.
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

std::string Executor::silent_job(TimePoint now) {
  const std::lock_guard lock(jobs_mutex_);
  const std::uint64_t beats = running_token_.beats();
  if (!running_ || beats != seen_beats_) {
    seen_beats_ = beats;
    seen_at_ = now;
    return {};
  }
  return now - seen_at_ > kJobSilence ? kSilentJob : std::string();
}

}  // namespace handsel
