// SPDX-License-Identifier: Apache-2.0
// Detects tasks of which only the running action remains after a restart of the supervisor. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "common/base/time.hpp"
#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Finds a task whose action runs without a goal, because this process was restarted during the
/// action.
class OrphanWatch {
 public:
  /// `timeout`: max time until a goal is sent again [s].
  explicit OrphanWatch(double timeout) : timeout_(timeout) {}

  /// Returns the failed status of a task without a goal for the timeout, once per task. `id`: task
  /// of the running action without a goal; nullopt: none.
  std::optional<TaskStatus> step(std::optional<std::uint64_t> id, TimePoint now);

 private:
  double timeout_;
  std::set<std::uint64_t> reported_;
  std::optional<TimePoint> since_;
};

}  // namespace handsel::supervisor
