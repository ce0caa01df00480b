// The place of the one task that may run, and the task statuses that are reported. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "components/supervisor/task/task_run.hpp"

namespace handsel::supervisor {

/// Owns the running task, reports its status and repeats the status reported last.
class TaskSlot {
 public:
  using Statuses = std::vector<TaskStatus>;

  /// The running task; nullptr: none.
  TaskRun* task() const { return task_.get(); }
  /// Takes a task that has begun and reports its status.
  void begin(std::unique_ptr<TaskRun> task, Statuses& out);
  /// Reports that a goal is refused, for a reason of at most one message.
  void refuse(const TaskGoal& goal, const std::string& reason, Statuses& out);
  /// Reports the end of a task that does not run here.
  void report_end(const TaskStatus& status, Statuses& out);
  /// Reports the status of the running task; a task that is over leaves the slot.
  void report(Statuses& out);
  /// Shows the running task as paused while `halted`. Returns whether its status has changed.
  bool show_pause(bool halted);
  /// Repeats the last status when `out` is empty and the last report is older than `period` [s].
  void repeat(TimePoint now, double period, Statuses& out);

 private:
  std::unique_ptr<TaskRun> task_;
  std::optional<TaskStatus> last_;
  TimePoint reported_at_{};
};

}  // namespace handsel::supervisor
