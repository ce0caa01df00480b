#include "components/supervisor/permission.hpp"

#include <algorithm>

namespace handsel::supervisor {

Permission::Permission(const config::SupervisorSettings& settings) : settings_(settings) {
  go_.override_factor = settings.speed_override();
}

void Permission::on(const ComponentHealth& health, TimePoint arrival) {
  if (health.state == HealthState::ok || health.state == HealthState::degraded) alive_[health.component] = arrival;
  if (health.state == HealthState::stopping) alive_.erase(health.component);
}

void Permission::on(const ExecutionStatus& status, TimePoint) {
  status_ = status;
  status_known_ = true;
  go_.epoch = std::max(go_.epoch, status.epoch);
}

void Permission::find_missing(TimePoint now) {
  missing_.clear();
  for (const auto& component : settings_.required()) {
    const auto it = alive_.find(component);
    if (it == alive_.end() || to_seconds(now - it->second) > settings_.health_timeout()) missing_.push_back(component);
  }
}

const Go& Permission::step(TimePoint now) {
  find_missing(now);
  const bool running = status_known_ && status_.motion == MotionState::running && status_.mode < Mode::hold;
  if (paused_) {
    go_.allowed = false;
    go_.reason = "paused on request";
  } else if (!missing_.empty() && !running) {
    go_.allowed = false;
    go_.reason = missing_.front() + " is not there";
  }
  if (!status_known_ || paused_ || !missing_.empty()) {
    clear_ = false;
    return go_;
  }

  constexpr std::uint32_t kNoGo = 1U << static_cast<unsigned>(Cause::no_go);
  const bool waits = status_.mode >= Mode::hold || !go_.allowed;
  const bool fault = status_.mode == Mode::fault;
  // A drive that was stopped by a person or by its own reflex waits for a person's word; the permission to move comes after it.
  constexpr std::uint32_t kDrive = 1U << static_cast<unsigned>(Cause::drive_not_enabled);
  if (acknowledge_ && status_.mode == Mode::stop && (status_.causes & kDrive) != 0) {
    ++go_.epoch;
    go_.acknowledge = true;
    go_.reason = "a person lets the drives go on";
    acknowledge_ = false;
  }
  if (!fault) acknowledge_ = false;  // said before there was a fault: does not count for the next
  const bool now_clear = waits && (status_.causes & ~kNoGo) == 0 && (!fault || acknowledge_);
  if (now_clear && !clear_) clear_since_ = now;
  clear_ = now_clear;
  if (clear_ && to_seconds(now - clear_since_) >= settings_.resume_delay()) {
    ++go_.epoch;
    go_.allowed = true;
    go_.acknowledge = fault;
    go_.reason = "all clear";
    acknowledge_ = false;
    clear_ = false;
  }
  return go_;
}

}  // namespace handsel::supervisor
