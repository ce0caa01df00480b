// The task planner and supervision (chapter section 2.1): goals become actions one at a time; their fate is watched and told. Pure.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/schema/supervisor.pb.h"
#include "common/messages/attention.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "components/supervisor/goal_inbox.hpp"
#include "components/supervisor/safety/lost_people.hpp"
#include "components/supervisor/safety/permission.hpp"
#include "components/supervisor/safety/safety_latches.hpp"
#include "components/supervisor/task/task_run.hpp"

namespace handsel::supervisor {

struct Outbox {
  std::vector<ActionGoal> action_goals;
  std::vector<TaskStatus> task_statuses;
  std::optional<Go> go;
  std::optional<SafetyState> safety;  ///< to be published; ages count from now
  std::optional<DurableState> store;  ///< to be stored; on_stored() or on_store_failure() answers, until then no other comes
};

class Supervisor {
 public:
  /// `first_action`: ids of action goals grow from here; unique over restarts. `restored`: what the store has kept, ages as of `now`.
  Supervisor(const config::SupervisorSettings& settings, Domain domain, Ability ability, std::uint64_t first_action,
             const DurableState& restored, TimePoint now);
  /// The same, started by a person: no latch stands.
  Supervisor(const config::SupervisorSettings& settings, Domain domain, Ability ability, std::uint64_t first_action);

  void on(const TaskGoal& goal, TimePoint arrival);
  void on(const Facts& facts, TimePoint arrival) { situation_.on(facts, arrival); }
  void on(const Scene& scene, TimePoint arrival) { situation_.on(scene, arrival); }
  void on(const ActionStatus& status, TimePoint) { situation_.on(status); }
  void on(const ComponentHealth& health, TimePoint arrival);
  void on(const ExecutionStatus& status, TimePoint arrival);
  void on(const RobotState& robot, TimePoint) { latches_.on(robot); }
  void on(const HumanState& people, TimePoint arrival, std::uint64_t writer) { lost_.on(people, arrival, writer); }
  void on(const AttentionAdvice& advice, TimePoint) { advice_ = advice; }
  void set_shoulder(const Vector3& shoulder) { situation_.set_shoulder(shoulder); }
  void set_other_arms(const std::vector<Ability::Arm>& arms) { situation_.set_other_arms(arms); }

  /// Goals that found no room so far.
  std::uint64_t goals_turned_away() const { return inbox_.turned_away(); }
  /// Scene and facts have come: tasks can be judged.
  bool knows_world() const { return situation_.known(); }
  /// The state of this revision has been stored.
  void on_stored(std::uint64_t revision);
  /// It has not; `reason` names the file, one sentence.
  void on_store_failure(const std::string& reason, TimePoint now);
  /// Why the state cannot be stored, one sentence; empty: the last attempt succeeded.
  const std::string& store_failure() const { return store_failure_; }
  /// `stamp`: system clock, from which stored ages count.
  void step(TimePoint now, Stamp stamp, Outbox& out);

 private:
  bool begin(const TaskGoal& goal, TimePoint now, Outbox& out);
  void refuse(const TaskGoal& goal, const std::string& reason, Outbox& out);
  void control(const TaskGoal& goal, Outbox& out);
  void heed(TimePoint now, TaskWishes& wishes);
  void look_for_orphan(TimePoint now, Outbox& out);
  void suspend(bool suspended);
  void show_pause();
  void keep(TimePoint now, Stamp stamp, Outbox& out);
  void answer(Outbox& out);
  void send_go(const Go& go, TimePoint now, Outbox& out);
  bool halted() const { return !latches_.permits() || suspended_; }
  void report(Outbox& out);

  config::SupervisorSettings settings_;
  Domain domain_;
  Permission permission_;
  SafetyLatches latches_;
  LostPeople lost_;
  Situation situation_;
  std::uint64_t next_action_;
  GoalInbox inbox_;
  std::unique_ptr<TaskRun> task_;
  std::optional<TaskStatus> last_;
  AttentionAdvice advice_;
  TaskChange heeded_{TaskChange::none};
  bool suspended_{false};            ///< by attention
  std::set<std::uint64_t> orphans_;  // told of
  std::optional<TimePoint> orphan_since_;
  TimePoint go_sent_{}, status_sent_{};
  Go sent_go_;
  std::uint64_t stored_{}, published_{};  // revisions
  bool storing_{false};
  std::optional<TimePoint> lost_noted_, safety_sent_, store_failed_at_;
  std::string store_failure_;
  struct Answer {
    std::uint64_t revision{};  // that must be stored before a person is answered
    TaskStatus status;
  };
  std::vector<Answer> answers_;
};

}  // namespace handsel::supervisor
