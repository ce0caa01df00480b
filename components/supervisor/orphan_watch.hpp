// Tasks of which only the running action is left after a restart of the supervisor. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "common/base/time.hpp"
#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Finds a task whose action runs although no goal asks for the task: this process was started anew
/// while the action ran.
class OrphanWatch {
 public:
  /// Returns the failed status of a task that has been without a goal for the timeout; each task is
  /// reported once. `id`: task of the running action that no goal asks for; nothing: there is none.
  std::optional<TaskStatus> step(std::optional<std::uint64_t> id, TimePoint now);

 private:
  std::set<std::uint64_t> reported_;
  std::optional<TimePoint> since_;
};

}  // namespace handsel::supervisor
