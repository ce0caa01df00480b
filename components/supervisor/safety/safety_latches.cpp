// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/safety_latches.hpp"

#include <algorithm>
#include <cmath>

#include "common/messages/names.hpp"
#include "components/supervisor/task/progress.hpp"

namespace handsel::supervisor {
namespace {

// Start of the remedy at the end of a reason.
constexpr const char* kHint = "; next: handsel task ";
// Max length of a cause in a reason, which has at most 256 characters.
constexpr std::size_t kMaxDetail = 100;

constexpr std::uint32_t kFaultCauses = bit(Cause::tracking_error) | bit(Cause::limit_violation);

/// Returns whether a person or the robot's own protection causes this mode of the robot side, not
/// missing set-points.
bool is_stop(DriveMode mode) {
  return mode == DriveMode::protective_stop || mode == DriveMode::user_stop ||
         mode == DriveMode::emergency_stop;
}

bool is_pressed(DriveMode mode) {
  return mode == DriveMode::user_stop || mode == DriveMode::emergency_stop;
}

std::string text_of(DriveMode mode) { return kDriveModeNames[static_cast<std::size_t>(mode)]; }

}  // namespace

DurableState fresh_state(std::uint64_t revision, double override_factor) {
  DurableState state;
  state.safety.revision = state.permission_revision = std::max<std::uint64_t>(revision, 1);
  state.safety.override_factor = override_factor;
  return state;
}

DurableState unknown_state(std::uint64_t revision, const std::string& reason) {
  DurableState state = fresh_state(revision, 1.0);
  state.safety.paused = state.safety.awaits_person = true;
  state.safety.reason = cut(reason, kMaxReason - 40) + kHint + "resume";
  return state;
}

SafetyLatches::SafetyLatches(DurableState restored)
    : state_(std::move(restored)), permitted_at_start_(permits()) {
  const std::string why = state_.safety.reason.substr(0, state_.safety.reason.find(kHint));
  if (state_.safety.fault) fault_reason_ = why;
  if (state_.safety.awaits_person && !state_.safety.fault) stop_reason_ = why;
  if (state_.safety.awaits_person && state_.safety.fault)
    stop_reason_ = "a stop from before the restart";
}

void SafetyLatches::change() {
  SafetyState& s = state_.safety;
  state_.permission_revision = ++s.revision;
  s.reason.clear();
  const auto add = [&](bool holds, const std::string& why) {
    if (holds) s.reason += (s.reason.empty() ? "" : "; ") + cut(why, kMaxDetail);
  };
  add(s.fault, fault_reason_);
  add(s.awaits_person, stop_reason_);
  add(s.paused && !s.awaits_person, "paused by a person");
  if (permits()) return;
  s.reason += std::string(kHint) + (s.fault ? "acknowledge" : "resume");
}

void SafetyLatches::pause() {
  if (state_.safety.paused) return;
  state_.safety.paused = true;
  change();
}

std::string SafetyLatches::why_not_yet() const {
  return is_pressed(drive_)
             ? "the robot is in " + text_of(drive_) + "; release the robot's stop first"
             : "";
}

std::string SafetyLatches::resume() {
  if (state_.safety.fault)
    return "a fault stands; deal with its cause, then `handsel task acknowledge`";
  if (std::string why = why_not_yet(); !why.empty()) return why;
  state_.safety.paused = state_.safety.awaits_person = false;
  change();
  return {};
}

std::string SafetyLatches::acknowledge() {
  if (std::string why = why_not_yet(); !why.empty()) return why;
  state_.safety.fault = state_.safety.awaits_person = false;
  change();
  return {};
}

void SafetyLatches::set_override(double factor) {
  factor = std::isfinite(factor) ? std::clamp(factor, 0.0, 1.0) : 0.0;
  if (factor == state_.safety.override_factor) return;
  state_.safety.override_factor = factor;
  change();
}

void SafetyLatches::on(const RobotState& robot) {
  const DriveMode before = std::exchange(drive_, robot.mode);
  const bool entered =
      robot.mode != before && is_stop(robot.mode) && (is_pressed(robot.mode) || !is_stop(before));
  if (!entered) return;
  state_.safety.awaits_person = true;
  stop_reason_ = "the robot was in " + text_of(robot.mode) +
                 (robot.refusal.empty() ? "" : ": " + robot.refusal);
  change();
}

void SafetyLatches::on(const ExecutionStatus& status, std::uint64_t acknowledged) {
  const bool present = (status.causes & kFaultCauses) != 0;
  if (status.mode != Mode::fault || state_.safety.fault ||
      (status.epoch < acknowledged && !present))
    return;
  state_.safety.fault = true;
  fault_reason_ = status.reason.empty() ? "a fault of the controller" : status.reason;
  change();
}

void SafetyLatches::on_missed_stop() {
  if (state_.safety.awaits_person) return;
  state_.safety.awaits_person = true;
  stop_reason_ = "the robot was stopped while no supervisor was there";
  change();
}

void SafetyLatches::on_store_failure(const std::string& reason) {
  if (state_.safety.paused && state_.safety.awaits_person && stop_reason_ == reason) return;
  state_.safety.paused = state_.safety.awaits_person = true;
  stop_reason_ = reason;
  change();
}

void SafetyLatches::set_lost(std::vector<Person> lost, Stamp stamp) {
  state_.safety.lost = std::move(lost);
  state_.safety.stamp = stamp;
  ++state_.safety.revision;
}

}  // namespace handsel::supervisor
