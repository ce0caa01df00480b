// When the robot may move: the motion-permission counter, "epoch", that each Go carries
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

/// What the durable state says about motion (safety_latches.hpp).
struct PermissionState {
  std::uint64_t revision{};     ///< of the state, carried by each Go
  bool permits{};               ///< no latch stands
  bool stored{};                ///< the state of this revision is on disk
  double override_factor{1.0};  ///< speed override, [0, 1]
  std::string reason;           ///< why it does not permit motion
};

/// A new epoch is granted when nothing but the missing permission holds the robot back, no latch
/// stands and the state is stored; permission is withdrawn at once while a latch stands or the task
/// is suspended, and, once the running trajectory has ended, when a required component is gone.
class Permission {
 public:
  explicit Permission(const settings::SupervisorSettings& settings) : settings_(settings) {}

  /// Notes that a required component is alive (ok, degraded) or gone (stopping).
  void on(const ComponentHealth& health, TimePoint arrival);
  /// Takes the status of the controller; the epoch never falls behind the one reported there.
  void on(const ExecutionStatus& status, TimePoint arrival);
  /// Attention suspends the task: no permission until it resumes.
  void suspend(bool suspended) { suspended_ = suspended; }
  /// A person has acknowledged the fault or stop that the controller reports now, if any: the next
  /// Go says so once its cause is gone.
  void acknowledge();
  /// Returns the motion-permission counter at which the last fault was acknowledged; reports of a
  /// fault from older epochs are old. Returns the largest number while that Go has yet to come.
  std::uint64_t acknowledged() const;

  /// Returns whether the controller waits for a person because of a stop that this process has
  /// missed: it has the Go in force, which permits motion, or said so in its first report since a
  /// start whose state permitted motion.
  bool missed_stop(bool permitted_at_start) const;
  /// Decides about the permission and returns the Go in force. A new epoch is granted only after
  /// the conditions have held for the configured resume delay.
  const Go& step(const PermissionState& state, TimePoint now);
  /// Required components that are not there; empty when all are.
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  /// Given by a person and not yet passed on by a Go.
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
