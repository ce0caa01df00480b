// SPDX-License-Identifier: Apache-2.0
// Records failed actions of one task: retries, and whether the task was given up. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/config/settings/supervisor.hpp"
#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Counts failures against the limits of the settings. After give_up() the task only recovers by
/// putting back the held object.
class FailureRecord {
 public:
  /// `settings` must outlive this object.
  explicit FailureRecord(const settings::SupervisorSettings& settings) : settings_(settings) {}

  /// Returns the first rule for this failure of an action; nullptr: none.
  const settings::FailureRule* rule(ActionKind kind, ActionFailure failure) const;
  /// Returns whether the rule allows another attempt at the action, and counts the attempt.
  bool retry(const settings::FailureRule* rule, const std::string& action);
  /// Stores the first action that failed finally.
  void note(const std::string& action, const std::string& reason);
  /// Returns the first action that failed finally, with its reason; empty: none.
  const std::string& first() const { return first_; }

  /// Gives up the task; actions may be tried again for the recovery.
  void give_up(const std::string& reason);
  /// Returns whether the task was given up.
  bool recovering() const { return !given_up_.empty(); }
  /// Returns why the task was given up; empty: it was not.
  const std::string& reason() const { return given_up_; }
  /// Counts a failed action of the recovery. Returns whether other actions may be tried.
  bool may_recover_otherwise() { return ++failed_recoveries_ <= settings_.max_recoveries; }

 private:
  const settings::SupervisorSettings& settings_;
  std::map<std::string, std::uint32_t> tries_;
  std::string given_up_;
  std::string first_;
  std::uint32_t failed_recoveries_{0};
};

}  // namespace handsel::supervisor
