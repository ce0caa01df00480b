// SPDX-License-Identifier: Apache-2.0
// Latches that prevent motion until a person releases them: pause, fault, stop of the robot, failed
// storage; and the speed override. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"

namespace handsel::supervisor {

/// The state that outlives the process: safety state and revision of its permissions.
struct DurableState {
  SafetyState safety;  ///< ages of `lost` count from `safety.stamp`
  /// `safety.revision` at the last change relevant to Go; lost people are not relevant.
  std::uint64_t permission_revision{};
};

/// Returns the state of a system that a person has just started.
DurableState fresh_state(std::uint64_t revision, double override_factor);
/// Returns the state for a missing, damaged or unwritable record: paused, waiting for a person.
DurableState unknown_state(std::uint64_t revision, const std::string& reason);

/// Transitions of the durable state. Every change gives a new revision.
class SafetyLatches {
 public:
  explicit SafetyLatches(DurableState restored);

  /// Pauses the robot by order of a person.
  void pause();
  /// Ends the pause and the wait after a stop by order of a person. Returns why not, one sentence;
  /// empty: done.
  std::string resume();
  /// Acknowledges a fault or stop by order of a person. Returns why not, one sentence; empty: done.
  std::string acknowledge();
  /// Sets the speed override by order of a person, [0, 1].
  void set_override(double factor);

  /// Latches a protective, user or emergency stop when the robot side enters one.
  void on(const RobotState& robot);
  /// Latches a fault of the controller. `acknowledged`: epoch at which the last fault was
  /// acknowledged; reports of older epochs are outdated, unless the cause of the fault still holds.
  void on(const ExecutionStatus& status, std::uint64_t acknowledged);
  /// Latches a stop that only the controller has observed: it has the present Go and still waits
  /// for a person.
  void on_missed_stop();
  /// Latches a wait for a person because the state could not be stored. `reason` names the file.
  void on_store_failure(const std::string& reason);
  /// Takes the lost people, with ages at `stamp`, which becomes `safety.stamp`.
  void set_lost(std::vector<Person> lost, Stamp stamp);

  /// Returns whether no pause, fault or wait for a person is latched.
  bool permits() const {
    return !state_.safety.paused && !state_.safety.fault && !state_.safety.awaits_person;
  }
  /// Returns whether the state permitted motion when it was restored.
  bool permitted_at_start() const { return permitted_at_start_; }
  /// Returns the current safety state, with the reason for which permits() is false.
  const SafetyState& safety() const { return state_.safety; }
  /// Returns the current state for storage.
  const DurableState& state() const { return state_; }

 private:
  std::string why_not_yet() const;
  void change();

  DurableState state_;
  bool permitted_at_start_;
  std::string fault_reason_, stop_reason_;
  DriveMode drive_{DriveMode::enabled};
};

}  // namespace handsel::supervisor
