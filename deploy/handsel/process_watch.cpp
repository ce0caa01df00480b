#include "deploy/handsel/process_watch.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/bus/executor.hpp"
#include "common/bus/process_state.hpp"

namespace handsel {
namespace {

constexpr Duration kCheckPeriod = std::chrono::milliseconds(100);  // that of the heartbeats
constexpr std::uint64_t kSpeakEvery = 2;                           // checks

std::string seconds(Duration time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", to_seconds(time));
  return text;
}

}  // namespace

ProcessWatch::ProcessWatch(Bus& bus, Launcher& launcher, const LivenessSettings& settings)
    : launcher_(launcher), settings_(settings), out_(bus.advertise<ComponentHealth>()), last_check_(monotonic_now()) {
  bus.subscribe<ComponentHealth>([this](const ComponentHealth& health, const Receipt&) { hear(health); });
  bus.every(kCheckPeriod, [this](TimePoint) { check(); });
}

void ProcessWatch::hear(const ComponentHealth& health) {
  const auto watched = watched_.find(health.component);
  if (watched == watched_.end() || static_cast<std::uint32_t>(watched->second.pid) != health.pid) return;
  heard_ = true;
  watched->second.job_silent = health.job_silent;
  watched->second.liveness.beat(monotonic_now(), watched->second.job_silent);
}

/// Heartbeats wait while a thread of this process waits for a processor, or while nobody listens on this one. When everybody is silent at
/// once it is the listener that is deaf.
void ProcessWatch::measure_own_delay(TimePoint now) {
  const Duration passed = now - last_check_, threads = own_threads_.update(getpid());
  const bool deaf = !heard_ && watched_.size() > 1;
  own_delay_ += deaf ? passed : std::max({Duration{}, passed - kCheckPeriod, threads - own_threads_delay_});
  own_threads_delay_ = threads;
  last_check_ = now;
  heard_ = false;
}

void ProcessWatch::check() {
  const TimePoint now = monotonic_now();
  measure_own_delay(now);
  ++checks_;
  for (const ProcessStatus& process : launcher_.processes()) {
    if (process.pid > 0) {
      judge(process, now);
    } else {
      watched_.erase(process.name);
      if (checks_ % kSpeakEvery == 0) speak_for(process);
    }
  }
}

void ProcessWatch::judge(const ProcessStatus& process, TimePoint now) {
  LifeSigns signs{.now = now, .state = process_state(process.pid), .main_delay = main_thread_delay(process.pid), .own_delay = own_delay_};
  const auto known = watched_.find(process.name);
  if (known == watched_.end() || known->second.pid != process.pid) {
    watched_.insert_or_assign(process.name, Watched{process.pid, Liveness(settings_, signs)});
    return;
  }
  Watched& watched = known->second;
  if (watched.job_silent) watched.total_delay = watched.threads.update(process.pid);
  signs.total_delay = watched.total_delay;
  if (watched.liveness.judge(signs) != Life::hung) return;
  const std::string why = watched.liveness.job_hung()
                              ? "a job has given no sign of life for more than " + seconds(settings_.silent_job_after)
                          : signs.state == 'T' ? "stopped and without heartbeat for more than " + seconds(settings_.hung_after)
                                               : "without heartbeat for more than " + seconds(settings_.hung_after);
  launcher_.replace(process.name, process.pid, "was hung, " + why);
}

void ProcessWatch::speak_for(const ProcessStatus& process) {
  constexpr std::size_t kLongest = 255;  // idl/system.idl
  ComponentHealth health;
  health.component = process.name;
  health.state = HealthState::stopping;
  health.reason = "restart " + std::to_string(process.restarts + 1) + " in " + seconds(process.wait) + "; it " + process.why;
  if (health.reason.size() > kLongest) health.reason.resize(kLongest);
  health.uptime = 0.0;
  out_->publish(health);
}

}  // namespace handsel
