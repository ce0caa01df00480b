// SPDX-License-Identifier: Apache-2.0
// Decides whether the robot may move: the epoch (number of the motion permission) in each Go
// (architecture: mode machine). Pure.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/supervisor.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"

namespace handsel::supervisor {

/// The durable state with regard to motion (safety_latches.hpp).
struct PermissionState {
  std::uint64_t revision{};     ///< revision of the state, contained in each Go
  bool permits{};               ///< whether no latch is set
  bool stored{};                ///< whether this revision is on disk
  double override_factor{1.0};  ///< speed override, [0, 1]
  std::string reason;           ///< why the state does not permit motion
};

/// Grants a new epoch if only the missing permission stops the robot, no latch is set and the state
/// is stored. Withdraws the permission immediately while a latch is set or the task is suspended,
/// and after the end of the running trajectory if a required component is gone.
class Permission {
 public:
  explicit Permission(const settings::SupervisorSettings& settings) : settings_(settings) {}

  /// Notes that a required component is alive (ok, degraded) or gone (stopping).
  void on(const ComponentHealth& health, TimePoint arrival);
  /// Takes the status of the controller; the epoch is at least the reported one.
  void on(const ExecutionStatus& status, TimePoint arrival);
  /// Suspends or resumes the task by attention; a suspended task has no permission.
  void suspend(bool suspended) { suspended_ = suspended; }
  /// Notes that a person has acknowledged the reported fault or stopped drives; lapses when that
  /// ends. Contained in the next Go for drives, in the Go that permits motion again for a fault.
  void acknowledge();
  /// Returns the epoch at which the last fault was acknowledged; fault reports of older epochs are
  /// outdated. Returns the max number before that Go is sent.
  std::uint64_t acknowledged() const;

  /// Returns whether the controller waits for a person after a stop that this process has missed:
  /// the controller has the present Go, which permits motion, or waits in its first report after a
  /// start whose state permitted motion.
  bool missed_stop(bool permitted_at_start) const;
  /// Updates and returns the present Go. Grants motion after the conditions have held for the
  /// resume delay; an acknowledgement of stopped drives has an epoch of its own, without delay.
  const Go& step(const PermissionState& state, TimePoint now);
  /// Returns the missing required components; empty: none.
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  /// Acknowledgement by a person that no Go contains yet.
  enum class Acknowledgement { none, of_drives, of_fault };
  Acknowledgement awaited() const;
  void find_missing(TimePoint now);
  void withdraw(const std::string& reason);
  void acknowledge_drives();
  void grant(bool fault);

  settings::SupervisorSettings settings_;
  std::map<std::string, TimePoint> alive_;
  std::vector<std::string> missing_;
  bool status_known_{false}, first_status_{false}, suspended_{false};
  Acknowledgement acknowledgement_{Acknowledgement::none};
  ExecutionStatus status_;
  TimePoint clear_since_{};
  bool clear_{false};
  std::uint64_t acknowledged_{};
  Go go_;
};

}  // namespace handsel::supervisor
