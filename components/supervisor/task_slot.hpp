// SPDX-License-Identifier: Apache-2.0
// Holds the one running task and reports task statuses. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "components/supervisor/task/task_run.hpp"

namespace handsel::supervisor {

/// Owns the running task, reports its status and repeats the last report.
class TaskSlot {
 public:
  using Statuses = std::vector<TaskStatus>;

  /// Returns the running task; nullptr: none.
  TaskRun* task() const { return task_.get(); }
  /// Takes a new task and reports its status.
  void begin(std::unique_ptr<TaskRun> task, Statuses& out);
  /// Reports the refusal of a goal with a reason, cut to the size of a message.
  void refuse(const TaskGoal& goal, const std::string& reason, Statuses& out);
  /// Reports the end of a task that is not in the slot.
  void report_end(const TaskStatus& status, Statuses& out);
  /// Reports the status of the running task; removes a finished task.
  void report(Statuses& out);
  /// Shows the running task as paused while `halted`. Returns whether its status has changed.
  bool show_pause(bool halted);
  /// Repeats the last status if `out` is empty and the last report is older than `period` [s].
  void repeat(TimePoint now, double period, Statuses& out);

 private:
  std::unique_ptr<TaskRun> task_;
  std::optional<TaskStatus> last_;
  TimePoint reported_at_{};
};

}  // namespace handsel::supervisor
