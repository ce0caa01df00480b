// SPDX-License-Identifier: Apache-2.0
// Task planning and supervision (chapter section 2.1): executes goals as successive actions, and
// monitors and reports their outcome. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/supervisor.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "components/supervisor/goal_inbox.hpp"
#include "components/supervisor/orphan_watch.hpp"
#include "components/supervisor/safety/go_sender.hpp"
#include "components/supervisor/safety/lost_people.hpp"
#include "components/supervisor/safety/permission.hpp"
#include "components/supervisor/safety/safety_latches.hpp"
#include "components/supervisor/safety/state_keeper.hpp"
#include "components/supervisor/task_slot.hpp"

namespace handsel::supervisor {

/// Messages and requests that one step of the supervisor produces.
struct Outbox {
  std::vector<ActionGoal> action_goals;   ///< to be sent, in order
  std::vector<TaskStatus> task_statuses;  ///< to be sent, in order
  std::optional<Go> go;                   ///< to be sent on a change, and repeated at the Go rate
  std::optional<SafetyState> safety;      ///< to be published; ages count from now
  /// To be stored; the next follows only after on_stored() or on_store_failure().
  std::optional<DurableState> store;
};

class Supervisor {
 public:
  /// `first_action`: first id of action goals, unique over restarts. `restored`: stored state, ages
  /// as of `now`.
  Supervisor(const settings::SupervisorSettings& settings, Domain domain, Ability ability,
             std::uint64_t first_action, const DurableState& restored, TimePoint now);
  /// Creates a supervisor started by a person, without latches.
  Supervisor(const settings::SupervisorSettings& settings, Domain domain, Ability ability,
             std::uint64_t first_action);

  /// Queues the goal for the next step(). A pause beyond the quota takes effect immediately.
  void on(const TaskGoal& goal, TimePoint arrival);
  /// Replaces the facts of the world model.
  void on(const Facts& facts, TimePoint arrival) { situation_.on(facts, arrival); }
  /// Replaces the scene of the world model.
  void on(const Scene& scene, TimePoint arrival) { situation_.on(scene, arrival); }
  /// Takes the status of the running action.
  void on(const ActionStatus& status, TimePoint) { situation_.on(status); }
  /// Notes that a required component is alive or stopping; that of SPARK also gives its start time.
  void on(const ComponentHealth& health, TimePoint arrival);
  /// Takes the status of the controller; latches a fault, or a stop missed by this process.
  void on(const ExecutionStatus& status, TimePoint arrival);
  /// Latches a protective, user or emergency stop when the robot side enters one.
  void on(const RobotState& robot, TimePoint) { latches_.on(robot); }
  /// Updates the lost people. `writer`: identifies the SPARK process.
  void on(const HumanState& people, TimePoint arrival, std::uint64_t writer) {
    lost_.on(people, arrival, writer);
    situation_.on(people);
  }
  /// Takes the advice of attention; the next step() acts on its change of the task.
  void on(const AttentionAdvice& advice, TimePoint) { advice_ = advice; }
  /// Sets the arms of the robot, whose reach applies from then on.
  void set_arms(std::vector<Ability::Arm> arms) { situation_.set_arms(std::move(arms)); }

  /// Returns the number of goals beyond the quota so far.
  std::uint64_t goals_turned_away() const { return inbox_.turned_away(); }
  /// Returns whether scene and facts have arrived, so that tasks can be evaluated.
  bool knows_world() const { return situation_.known(); }
  /// Notes that the state of this revision has been stored.
  void on_stored(std::uint64_t revision) { keeper_.on_stored(revision); }
  /// Notes a failure to store the state; `reason` names the file, one sentence.
  void on_store_failure(const std::string& reason, TimePoint now);
  /// Returns why the state cannot be stored, one sentence; empty: the last attempt succeeded.
  const std::string& store_failure() const { return keeper_.store_failure(); }
  /// Runs one cycle: controls, goals, the running task, permission and storage; fills `out`.
  /// `stamp`: system clock, from which stored ages count.
  void step(TimePoint now, Stamp stamp, Outbox& out);

 private:
  bool begin(const TaskGoal& goal, TimePoint now, Outbox& out);
  void control(const TaskGoal& goal, Outbox& out);
  void follow_advice(TimePoint now, TaskWishes& wishes);
  std::optional<std::uint64_t> unasked_task() const;
  void suspend(bool suspended);
  bool halted() const { return !latches_.permits() || suspended_; }

  settings::SupervisorSettings settings_;
  Domain domain_;
  Permission permission_;
  GoSender go_sender_;
  SafetyLatches latches_;
  LostPeople lost_;
  StateKeeper keeper_;
  Situation situation_;
  std::uint64_t next_action_;
  GoalInbox inbox_;
  TaskSlot slot_;
  OrphanWatch orphans_;
  AttentionAdvice advice_;
  TaskChange followed_{TaskChange::none};  ///< last executed change of the advice
  bool suspended_{false};                  ///< by attention
};

}  // namespace handsel::supervisor
