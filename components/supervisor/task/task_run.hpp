// SPDX-License-Identifier: Apache-2.0
// Runs one task from goal to end: planning, execution, monitoring, replanning. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/config/settings/supervisor.hpp"
#include "components/supervisor/situation.hpp"
#include "components/supervisor/task/action_dispatch.hpp"
#include "components/supervisor/task/expected_effects.hpp"
#include "components/supervisor/task/failure_record.hpp"
#include "components/supervisor/task/persistent.hpp"
#include "components/supervisor/task/planning_problem.hpp"
#include "components/supervisor/task/progress.hpp"

namespace handsel::supervisor {

/// Requests of a task in one step.
struct TaskWishes {
  std::vector<ActionGoal> action_goals;  ///< to be sent, in order, including cancellations
  bool changed{false};                   ///< whether the status must be reported
};

class TaskRun {
 public:
  TaskRun(const settings::SupervisorSettings& settings, const Domain& domain, Situation& situation,
          const TaskGoal& goal, TimePoint now);

  enum class Start { begun, refused, unsure };
  /// Evaluates the goal and makes the first plan. `unsure`: something named in the goal is not
  /// observed yet or not in the required state; `status().reason` names it.
  Start start(TimePoint now);

  /// Runs one cycle: follows the running action, plans again, sends the next action. `missing`:
  /// required components that are gone; `next_id`: id of the next action, counted up.
  void step(TimePoint now, const std::vector<std::string>& missing, std::uint64_t go_epoch,
            std::uint64_t& next_id, TaskWishes& wishes);
  /// Shows the task as paused or running; a task that is over keeps its state. No action is sent
  /// while paused.
  void pause(bool paused);
  /// Ends the task as cancelled at once and cancels its running action.
  void cancel(TaskWishes& wishes);
  /// Ends the task in an orderly sequence: puts back the held object.
  void abort(const std::string& reason, TimePoint now, TaskWishes& wishes);
  /// Gives the held object to a person instead; false: no object, or already doing so.
  bool give_instead(const std::string& person, TimePoint now, TaskWishes& wishes);

  /// Returns whether the task has succeeded, failed or was cancelled.
  bool over() const { return stage_ == Stage::over; }
  /// Returns the status with plan and tree brought up to date and texts cut to the size of the
  /// message.
  const TaskStatus& status();
  /// Goal of the task, with the destination filled in where `surface` named it.
  const TaskGoal& goal() const { return problem_.goal(); }

 private:
  enum class Stage {
    searching,  // for a person; there is no plan yet
    planned,
    over,
  };

  void search(TimePoint now, TaskWishes& wishes);
  void adopt(Plan plan);
  Plan plan_from(const State& state) const;
  State believed(TimePoint now) const { return effects_.believed(situation_.world(), now); }
  bool replan(TimePoint now);
  void send(TimePoint now, std::uint64_t go_epoch, std::uint64_t& next_id, TaskWishes& wishes);
  void follow(TimePoint now, std::uint64_t go_epoch, std::uint64_t& next_id, TaskWishes& wishes);
  void watch(TimePoint now, TaskWishes& wishes);
  void ended(TimePoint now);
  void answer_failure(ActionFailure failure, const std::string& reason, TimePoint now);
  void give_up(const std::string& reason, TimePoint now);
  void all_done(TimePoint now);
  void finish(TaskState state, const std::string& reason);
  void say(const std::string& phase, TaskWishes& wishes);
  bool is_stranded(TimePoint now, const std::vector<std::string>& missing);

  const settings::SupervisorSettings& settings_;
  Situation& situation_;
  PlanningProblem problem_;
  ExpectedEffects effects_;
  ActionDispatch dispatch_;
  FailureRecord failures_;
  Progress progress_;
  TimePoint accepted_;
  TaskStatus status_;
  Stage stage_{Stage::searching};
  TimePoint not_before_{};  // when the next action may be sent
  Persistent broken_, obsolete_, hopeless_, missing_;
  std::uint32_t replans_{0};
};

}  // namespace handsel::supervisor
