// The latches that hold the robot until a person releases them: pause, fault, stop of the robot,
// failed storage; and the speed override. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"

namespace handsel::supervisor {

/// What outlives the process: the safety state and the revision its permissions carry.
struct DurableState {
  SafetyState safety;  ///< ages of `lost` count from `safety.stamp`
  /// `safety.revision` at the last change that matters to Go; lost people do not matter.
  std::uint64_t permission_revision{};
};

/// Returns the state of a system that a person has just started.
DurableState fresh_state(std::uint64_t revision, double override_factor);
/// Returns the state that a missing, damaged or unwritable record stands for: paused, waiting for a
/// person.
DurableState unknown_state(std::uint64_t revision, const std::string& reason);

/// Transitions of the durable state. Every change gives a new revision.
class SafetyLatches {
 public:
  explicit SafetyLatches(DurableState restored);

  /// A person pauses the robot.
  void pause();
  /// A person resumes: ends the pause and the wait after a stop. Returns why not, one sentence;
  /// empty: done.
  std::string resume();
  /// A person has dealt with the cause of a fault or stop. Returns why not, one sentence; empty:
  /// done.
  std::string acknowledge();
  /// A person sets the speed override, [0, 1].
  void set_override(double factor);

  /// Latches a protective, user or emergency stop when the robot side enters one.
  void on(const RobotState& robot);
  /// Latches a fault of the controller. `acknowledged`: motion-permission counter at which the last
  /// fault was acknowledged; reports of an older epoch are old, unless the cause of the fault still
  /// holds.
  void on(const ExecutionStatus& status, std::uint64_t acknowledged);
  /// The controller has seen a stop that this process has missed: it has the Go in force and still
  /// waits for a person.
  void on_missed_stop();
  /// The state could not be stored: latches a wait for a person. `reason` names the file.
  void on_store_failure(const std::string& reason);
  /// Takes the people lost from sight; `safety.stamp` becomes `stamp`, from which their ages count.
  void set_lost(std::vector<Person> lost, Stamp stamp);

  /// Returns whether no pause, fault or wait for a person is latched.
  bool permits() const {
    return !state_.safety.paused && !state_.safety.fault && !state_.safety.awaits_person;
  }
  /// Returns whether the state permitted motion when it was restored.
  bool permitted_at_start() const { return permitted_at_start_; }
  /// Current safety state; its reason says why permits() is false.
  const SafetyState& safety() const { return state_.safety; }
  /// Current state as it has to be stored.
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
