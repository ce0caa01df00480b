// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/permission.hpp"

#include <algorithm>
#include <limits>

namespace handsel::supervisor {

void Permission::on(const ComponentHealth& health, TimePoint arrival) {
  if (std::find(settings_.required.begin(), settings_.required.end(), health.component) ==
      settings_.required.end())
    return;
  if (health.state == HealthState::ok || health.state == HealthState::degraded)
    alive_[health.component] = arrival;
  if (health.state == HealthState::stopping) alive_.erase(health.component);
}

void Permission::on(const ExecutionStatus& status, TimePoint) {
  status_ = status;
  first_status_ = !status_known_;
  status_known_ = true;
  go_.epoch = std::max(go_.epoch, status.epoch);
}

void Permission::find_missing(TimePoint now) {
  missing_.clear();
  for (const auto& component : settings_.required) {
    const auto it = alive_.find(component);
    if (it == alive_.end() || to_seconds(now - it->second) > settings_.health_timeout)
      missing_.push_back(component);
  }
}

/// Returns the reported state that a person must acknowledge.
Permission::Acknowledgement Permission::awaited() const {
  constexpr std::uint32_t kDrive = 1U << static_cast<unsigned>(Cause::drive_not_enabled);
  if (!status_known_) return Acknowledgement::none;
  if (status_.mode == Mode::fault) return Acknowledgement::of_fault;
  return status_.mode == Mode::stop && (status_.causes & kDrive) != 0 ? Acknowledgement::of_drives
                                                                      : Acknowledgement::none;
}

void Permission::acknowledge() { acknowledgement_ = awaited(); }

std::uint64_t Permission::acknowledged() const {
  return acknowledgement_ == Acknowledgement::of_fault ? std::numeric_limits<std::uint64_t>::max()
                                                       : acknowledged_;
}

bool Permission::missed_stop(bool permitted_at_start) const {
  constexpr std::uint32_t kAwaits = 1U << static_cast<unsigned>(Cause::awaits_person);
  const bool has_go = go_.allowed && status_.epoch == go_.epoch;
  return status_known_ && (status_.causes & kAwaits) != 0 &&
         ((first_status_ && permitted_at_start) || has_go);
}

void Permission::withdraw(const std::string& reason) {
  go_.allowed = false;
  go_.reason = reason;
}

/// Lets a drive continue that a person or its own reflex has stopped; the permission to move comes
/// after the resume delay.
void Permission::acknowledge_drives() {
  ++go_.epoch;
  go_.allowed = false;
  go_.acknowledge = true;
  go_.reason = "a person lets the drives continue";
  acknowledgement_ = Acknowledgement::none;
}

void Permission::grant(bool fault) {
  ++go_.epoch;
  go_.allowed = true;
  go_.acknowledge = fault;
  go_.reason = "all clear";
  if (fault) acknowledged_ = go_.epoch;
  acknowledgement_ = Acknowledgement::none;
  clear_ = false;
}

const Go& Permission::step(const PermissionState& state, TimePoint now) {
  find_missing(now);
  if (acknowledgement_ != awaited())
    acknowledgement_ = Acknowledgement::none;  // the acknowledged state is over
  go_.state_revision = state.revision;
  go_.override_factor = state.override_factor;
  const bool running =
      status_known_ && status_.motion == MotionState::running && status_.mode < Mode::hold;
  if (!state.permits)
    withdraw(state.reason);
  else if (suspended_)
    withdraw("suspended by attention");
  else if (!missing_.empty() && !running)
    withdraw(missing_.front() + " is not there");
  if (!status_known_ || !state.permits || suspended_ || !missing_.empty()) {
    clear_ = false;
    return go_;
  }

  constexpr std::uint32_t kPermission =
      1U << static_cast<unsigned>(Cause::no_go) | 1U << static_cast<unsigned>(Cause::awaits_person);
  const bool waits = status_.mode >= Mode::hold || !go_.allowed;
  const bool fault = status_.mode == Mode::fault;
  if (acknowledgement_ == Acknowledgement::of_drives) acknowledge_drives();
  const bool acknowledged = !fault || acknowledgement_ == Acknowledgement::of_fault;
  const bool now_clear =
      waits && state.stored && (status_.causes & ~kPermission) == 0 && acknowledged;
  if (now_clear && !clear_) clear_since_ = now;
  clear_ = now_clear;
  if (clear_ && to_seconds(now - clear_since_) >= settings_.resume_delay) grant(fault);
  return go_;
}

}  // namespace handsel::supervisor
