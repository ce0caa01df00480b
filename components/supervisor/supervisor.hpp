// The task planner and supervision (chapter section 2.1): goals become actions one at a time; their fate is watched and told. Pure.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/supervisor.pb.h"
#include "common/messages/attention.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "components/supervisor/permission.hpp"
#include "components/supervisor/task_run.hpp"

namespace handsel::supervisor {

struct Outbox {
  std::vector<ActionGoal> action_goals;
  std::vector<TaskStatus> task_statuses;
  std::optional<Go> go;
};

class Supervisor {
 public:
  /// `first_action`: ids of action goals grow from here; unique over restarts.
  Supervisor(const config::SupervisorSettings& settings, Domain domain, Ability ability, std::uint64_t first_action);

  void on(const TaskGoal& goal, TimePoint arrival);
  void on(const Facts& facts, TimePoint arrival) { situation_.on(facts, arrival); }
  void on(const Scene& scene, TimePoint arrival) { situation_.on(scene, arrival); }
  void on(const ActionStatus& status, TimePoint) { situation_.on(status); }
  void on(const ComponentHealth& health, TimePoint arrival) { permission_.on(health, arrival); }
  void on(const ExecutionStatus& status, TimePoint arrival) { permission_.on(status, arrival); }
  void on(const AttentionAdvice& advice, TimePoint) { advice_ = advice; }
  void set_shoulder(const Vector3& shoulder) { situation_.set_shoulder(shoulder); }
  void set_other_arms(const std::vector<Ability::Arm>& arms) { situation_.set_other_arms(arms); }

  /// Scene and facts have come: tasks can be judged.
  bool knows_world() const { return situation_.known(); }
  void step(TimePoint now, Outbox& out);

 private:
  bool begin(const TaskGoal& goal, TimePoint now, Outbox& out);
  void refuse(const TaskGoal& goal, const std::string& reason, Outbox& out);
  void control(const TaskGoal& goal, Outbox& out);
  void heed(TimePoint now, TaskWishes& wishes);
  void look_for_orphan(TimePoint now, Outbox& out);
  void pause(bool paused);
  void report(Outbox& out);

  config::SupervisorSettings settings_;
  Domain domain_;
  Permission permission_;
  Situation situation_;
  std::uint64_t next_action_;
  std::vector<TaskGoal> inbox_;
  std::unique_ptr<TaskRun> task_;
  std::optional<TaskStatus> last_;
  std::vector<std::uint64_t> known_goals_;
  AttentionAdvice advice_;
  TaskChange heeded_{TaskChange::none};
  bool paused_by_attention_{false};
  std::set<std::uint64_t> orphans_;  // told of
  std::optional<TimePoint> orphan_since_;
  TimePoint go_sent_{}, status_sent_{};
  Go sent_go_;
};

}  // namespace handsel::supervisor
