// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/process_watch.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/bus/executor.hpp"
#include "common/bus/process_state.hpp"

namespace handsel {
namespace {

constexpr Duration kCheckPeriod = std::chrono::milliseconds(100);  // period of the heartbeats
constexpr std::uint64_t kSpeakEvery = 2;                           // checks per report
constexpr Duration kLately = 5 * kCheckPeriod;

std::string seconds(Duration time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", to_seconds(time));
  return text;
}

}  // namespace

ProcessWatch::ProcessWatch(Bus& bus, Launcher& launcher, const LivenessSettings& settings)
    : launcher_(launcher),
      settings_(settings),
      out_(bus.advertise<ComponentHealth>()),
      last_check_(monotonic_now()) {
  bus.subscribe<ComponentHealth>(
      [this](const ComponentHealth& health, const Receipt&) { on_health(health); });
  bus.every(kCheckPeriod, [this](TimePoint) { check(); });
}

void ProcessWatch::on_health(const ComponentHealth& health) {
  const auto watched = watched_.find(health.component);
  if (watched == watched_.end() || static_cast<std::uint32_t>(watched->second.pid) != health.pid)
    return;
  Watched& process = watched->second;
  process.last_beat = monotonic_now();
  process.job_silent = health.job_silent;
  process.liveness.beat(process.last_beat, process.job_silent);
}

/// Returns whether most processes are silent at once: then the listener, the transport or the
/// machine is at fault. A stopped process (SIGSTOP) does not count, as its silence has a known
/// cause.
bool ProcessWatch::majority_is_silent(TimePoint now) const {
  std::size_t expected = 0, beating = 0;
  for (const auto& [name, process] : watched_) {
    if (process.last_beat == TimePoint{} || process.state == 'T') continue;
    ++expected;
    beating += now - process.last_beat < kLately;
  }
  return expected > 1 && 2 * beating < expected;
}

/// Adds the time in which heartbeats waited because this process had no processor, or received
/// none.
void ProcessWatch::measure_own_delay(TimePoint now) {
  const Duration passed = now - last_check_, threads = own_threads_.update(getpid());
  const Duration late = std::max({Duration{}, passed - kCheckPeriod, threads - own_threads_delay_});
  own_delay_ += majority_is_silent(now) ? passed : late;
  own_threads_delay_ = threads;
  last_check_ = now;
}

void ProcessWatch::check() {
  const TimePoint now = monotonic_now();
  measure_own_delay(now);
  ++checks_;
  for (const ProcessStatus& process : launcher_.processes()) {
    if (process.pid > 0) {
      assess(process, now);
    } else {
      watched_.erase(process.name);
      if (checks_ % kSpeakEvery == 0) speak_for(process);
    }
  }
}

void ProcessWatch::assess(const ProcessStatus& process, TimePoint now) {
  LifeSigns signs{.now = now,
                  .state = process_state(process.pid),
                  .main_delay = main_thread_delay(process.pid),
                  .own_delay = own_delay_};
  const auto known = watched_.find(process.name);
  if (known == watched_.end() || known->second.pid != process.pid) {
    watched_.insert_or_assign(process.name, Watched{process.pid, Liveness(settings_, signs)});
    return;
  }
  Watched& watched = known->second;
  watched.state = signs.state;
  if (watched.job_silent) watched.total_delay = watched.threads.update(process.pid);
  signs.total_delay = watched.total_delay;
  if (watched.liveness.assess(signs) != Life::hung) return;
  const std::string why =
      watched.liveness.job_hung()
          ? "a job has given no sign of life for more than " + seconds(settings_.silent_job_after)
      : signs.state == 'T'
          ? "stopped and without heartbeat for more than " + seconds(settings_.hung_after)
          : "without heartbeat for more than " + seconds(settings_.hung_after);
  launcher_.replace(process.name, process.pid, "was hung, " + why);
}

void ProcessWatch::speak_for(const ProcessStatus& process) {
  constexpr std::size_t kMaxReason = 255;  // bound in idl/system.idl
  ComponentHealth health;
  health.component = process.name;
  health.state = HealthState::stopping;
  health.reason = "restart " + std::to_string(process.restarts + 1) + " in " +
                  seconds(process.wait) + "; it " + process.why;
  if (health.reason.size() > kMaxReason) health.reason.resize(kMaxReason);
  health.uptime = 0.0;
  out_->publish(health);
}

}  // namespace handsel
