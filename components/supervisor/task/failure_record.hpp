// Failures of the actions of one task: retries, and whether the task was given up. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/config/settings/supervisor.hpp"
#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Counts failures against the limits of the settings. After give_up() the task only recovers: what
/// the robot holds is put back.
class FailureRecord {
 public:
  /// `settings` must outlive this object.
  explicit FailureRecord(const settings::SupervisorSettings& settings) : settings_(settings) {}

  /// Returns the first rule for this failure of an action; nullptr: none.
  const settings::FailureRule* rule(ActionKind kind, ActionFailure failure) const;
  /// Returns whether the rule allows another attempt at the action, and counts the attempt.
  bool retry(const settings::FailureRule* rule, const std::string& action);
  /// Remembers the first action that failed for good.
  void note(const std::string& action, const std::string& reason);
  /// The first action that failed for good, with its reason; empty: none.
  const std::string& first() const { return first_; }

  /// The task is given up; actions may be tried again for the recovery.
  void give_up(const std::string& reason);
  /// Returns whether the task was given up.
  bool recovering() const { return !given_up_.empty(); }
  /// Why the task was given up; empty: it was not.
  const std::string& reason() const { return given_up_; }
  /// Counts an action of the recovery that failed. Returns whether others may be tried.
  bool may_recover_otherwise() { return ++failed_recoveries_ <= settings_.max_recoveries; }

 private:
  const settings::SupervisorSettings& settings_;
  std::map<std::string, std::uint32_t> tries_;
  std::string given_up_;
  std::string first_;
  std::uint32_t failed_recoveries_{0};
};

}  // namespace handsel::supervisor
