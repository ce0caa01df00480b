// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/go_gate.hpp"

#include <utility>

namespace handsel::trajectory_controller {
namespace {

bool is_stop(DriveMode mode) {
  return mode == DriveMode::protective_stop || mode == DriveMode::user_stop ||
         mode == DriveMode::emergency_stop;
}

}  // namespace

const char* text_of(GoRefusal refusal) {
  switch (refusal) {
    case GoRefusal::none:
      return "";
    case GoRefusal::no_state:
      return "the last Go was issued from no safety state";
    case GoRefusal::older_state:
      return "the last Go was issued from an older safety state than is known here; a person has "
             "to resume";
    case GoRefusal::older_epoch:
      return "the last Go is older than the one in force";
  }
  return "";
}

GoRefusal GoGate::receive(const Go& go) noexcept {
  last_refusal_ = go.state_revision == 0           ? GoRefusal::no_state
                  : go.state_revision < revision_  ? GoRefusal::older_state
                  : received_ && go.epoch < epoch_ ? GoRefusal::older_epoch
                                                   : GoRefusal::none;
  if (last_refusal_ == GoRefusal::no_state || last_refusal_ == GoRefusal::older_state)
    allowed_ = false;
  if (last_refusal_ != GoRefusal::none) return last_refusal_;
  if (!received_) {
    first_epoch_ = go.epoch;
    if (waits_) stop_revision_ = go.state_revision;  // the stop was received before any Go
  }
  received_ = true;
  epoch_ = go.epoch;
  revision_ = go.state_revision;
  allowed_ = go.allowed;
  if (allowed_ && revision_ > stop_revision_) waits_ = false;
  return last_refusal_;
}

void GoGate::receive(const SafetyState& state) noexcept {
  awaits_person_ = state.paused || state.fault || state.awaits_person;
}

bool GoGate::awaits_person() const noexcept {
  return !allowed() && (waits_ || awaits_person_ || last_refusal_ == GoRefusal::older_state);
}

void GoGate::receive(DriveMode mode) noexcept {
  const DriveMode before = std::exchange(drive_, mode);
  const bool pressed = mode == DriveMode::user_stop || mode == DriveMode::emergency_stop;
  if (mode == before || !is_stop(mode) || (!pressed && is_stop(before))) return;
  waits_ = true;
  stop_revision_ = revision_;
}

}  // namespace handsel::trajectory_controller
