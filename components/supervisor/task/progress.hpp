// SPDX-License-Identifier: Apache-2.0
// Tracks the execution of a plan and the outcome of previous plans. Pure.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

/// Quotas of one TaskStatus (idl/task.idl).
inline constexpr std::size_t kMaxSteps = 64, kMaxLines = 128, kMaxText = 128, kMaxReason = 256,
                             kMaxPhase = 64;
/// Returns the text if it has at most `max_size` bytes, else its beginning with "..." at that
/// length. `max_size` >= 3.
std::string cut(const std::string& text, std::size_t max_size);

class Progress {
 public:
  /// Continues with another plan. Remaining actions of the old plan that are not in the new one
  /// count as dropped, with the reason `why`.
  void adopt(Plan plan, const std::function<std::string(const PlannedAction&)>& why);
  /// Continues with another plan whose first action is the running one.
  void adopt_after_running(Plan plan, const std::function<std::string(const PlannedAction&)>& why);

  /// Returns the due or running action; nullptr: all are over. Invalid after the plan is replaced.
  const PlannedAction* current() const {
    return next_ < plan_.actions.size() ? &plan_.actions[next_] : nullptr;
  }
  /// Returns the actions from the current one on, or after it.
  std::vector<PlannedAction> left(bool after = false) const;
  /// Returns the present plan, including finished actions.
  const Plan& plan() const { return plan_; }
  /// Returns the reasons of dropped actions, in order, each once.
  const std::vector<std::string>& dropped() const { return dropped_; }

  /// Marks the current action as running.
  void begin() { mark(StepState::running, ""); }
  /// Marks the current action as done and proceeds to the next one.
  void done();
  /// Marks the current action as failed; it stays the current one.
  void failed(const std::string& reason) { mark(StepState::failed, reason); }
  /// Marks the current action as dropped and adds the reason to dropped(); it stays the current
  /// one.
  void drop(const std::string& reason);
  /// Marks the current action for another attempt.
  void again(const std::string& reason) { mark(StepState::waiting, reason); }

  /// Writes plan, step, tree and cost; `goal` is the first line of the tree.
  void write(const std::string& goal, TaskStatus& out) const;

 private:
  struct Mark {
    StepState state{StepState::waiting};
    std::string reason;
  };
  void mark(StepState state, const std::string& reason);
  void note_dropped(const std::string& reason);
  void put_away();

  std::vector<PlanStep> past_;
  std::vector<std::string> past_plan_;
  std::vector<std::string> dropped_;
  Plan plan_;
  std::vector<Mark> marks_;
  std::size_t next_{0};
};

}  // namespace handsel::supervisor
