// SPDX-License-Identifier: Apache-2.0
// Performs a scenario's tasks through TaskGoal and TaskStatus and watches the simulator's oracle.
// Works on any bus.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/config/schema/scenario.pb.h"
#include "deploy/handsel/system/observer.hpp"

namespace handsel {

/// Without a sample about a task for so long its goal is sent again: the supervisor reports it more
/// often, and one goal twice is one task.
inline constexpr Duration kTaskSilence = std::chrono::seconds(2);
// the supervisor gives a thing that is named two seconds to be seen
inline constexpr Duration kAnswerTimeout = std::chrono::seconds(4);

/// "give mug to anna"
std::string describe(const TaskGoal& goal);
/// The scenario's task as a goal; throws ConfigError for a kind that is none.
TaskGoal make_goal(const config::TaskDescription& task, std::uint64_t id);
/// All of them, in order, with ids from 1; throws ConfigError also when there is none.
std::vector<TaskGoal> scenario_goals(const config::Scenario& scenario);
/// Returns true for succeeded, failed, cancelled and refused.
bool is_over(TaskState state);

struct StepOutcome {
  std::string step;   ///< as in TaskStatus::plan, e.g. "pick mug"
  double started{};   ///< since the performance began [s]
  double duration{};  ///< [s]
};

struct TaskOutcome {
  std::string task;  ///< "give mug to anna"
  /// Give: the oracle saw the handover. Receive: the oracle saw the handover, and the object stands
  /// on a surface. Other kinds: as the supervisor reports.
  bool success{};
  bool timed_out{};  ///< it was not done within the time of all tasks
  /// As the supervisor said last; reason also when the oracle disagrees.
  std::string state, reason;
  double started{}, duration{};  ///< [s]
  double first_motion{-1};  ///< after the goal was given the robot moved first [s]; negative: never
  /// Give, receive: after the goal was given the taking party first held the object alone [s];
  /// negative: never.
  double handover{-1};
  std::vector<StepOutcome> steps;  ///< those that began, in order
  Refusals refusals;               ///< as the supervisor reported last
};

class Performer {
 public:
  /// Begins as soon as `ready` holds. Throws as scenario_goals().
  Performer(Bus& bus, Observer& observer, const config::Scenario& scenario, double timeout,
            std::function<bool()> ready);

  /// Returns true after the last task, a failed one unless the scenario continues, the timeout or
  /// abort().
  bool finished() const { return phase_ == Phase::finished; }
  /// Returns true when finished and every task of the scenario has succeeded.
  bool succeeded() const;
  /// Returns true once `ready` has held, or after abort().
  bool started() const { return phase_ != Phase::waiting; }
  /// Of the performance, clock of the bus; valid once started.
  TimePoint begin() const { return begin_; }
  /// Of the performance [s], valid once finished.
  double duration() const { return to_seconds(end_ - begin_); }
  /// Returns the tasks begun so far; the last one may still run.
  const std::vector<TaskOutcome>& outcomes() const { return outcomes_; }
  /// Ends it now: the running task counts as failed for this reason.
  void abort(const std::string& reason);

 private:
  enum class Phase { waiting, running, verifying, finished };
  void tick(TimePoint now);
  void begin_task(TimePoint now);
  void follow(TimePoint now);
  void verify(TimePoint now);
  void conclude(TimePoint now);
  void note_step(const TaskStatus& status, TimePoint now);

  Bus& bus_;
  Observer& observer_;
  std::vector<TaskGoal> goals_;
  std::unique_ptr<Publisher<TaskGoal>> publisher_;
  std::function<bool()> ready_;
  Duration timeout_;
  Phase phase_{Phase::waiting};
  std::size_t current_{0};
  std::uint64_t handovers_before_{0};  // as the task began
  bool continue_after_failure_;
  TimePoint begin_{}, end_{}, task_begin_{}, last_sent_{}, verify_begin_{};
  std::vector<TaskOutcome> outcomes_;
};

}  // namespace handsel
