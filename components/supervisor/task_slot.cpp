// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task_slot.hpp"

namespace handsel::supervisor {

void TaskSlot::begin(std::unique_ptr<TaskRun> task, Statuses& out) {
  task_ = std::move(task);
  report(out);
}

void TaskSlot::refuse(const TaskGoal& goal, const std::string& reason, Statuses& out) {
  TaskStatus status;
  status.id = goal.id;
  status.kind = goal.kind;
  status.state = TaskState::refused;
  status.reason = cut(reason, kMaxReason);
  out.push_back(status);
  if (!task_) last_ = status;
}

void TaskSlot::report_end(const TaskStatus& status, Statuses& out) {
  out.push_back(status);
  last_ = status;
}

void TaskSlot::report(Statuses& out) {
  if (!task_) return;
  out.push_back(task_->status());
  if (!task_->over()) return;
  last_ = task_->status();
  task_.reset();
}

bool TaskSlot::show_pause(bool halted) {
  if (!task_ || (task_->status().state == TaskState::paused) == halted) return false;
  if (!task_->over()) task_->pause(halted);
  return true;
}

void TaskSlot::repeat(TimePoint now, double period, Statuses& out) {
  if (!out.empty()) {
    reported_at_ = now;
  } else if (to_seconds(now - reported_at_) >= period) {
    if (task_)
      report(out);
    else if (last_)
      out.push_back(*last_);
    reported_at_ = now;
  }
}

}  // namespace handsel::supervisor
