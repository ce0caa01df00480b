// The task planner and supervision (chapter section 2.1): goals become actions one at a time; their fate is watched and told. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/supervisor.pb.h"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "components/supervisor/permission.hpp"
#include "components/supervisor/task_planner.hpp"

namespace handsel::supervisor {

struct Outbox {
  std::vector<ActionGoal> action_goals;
  std::vector<TaskStatus> task_statuses;
  std::optional<Go> go;
};

class Supervisor {
 public:
  /// `first_action`: ids of action goals grow from here; unique over restarts.
  Supervisor(const config::SupervisorSettings& settings, std::uint64_t first_action);

  void on(const TaskGoal& goal, TimePoint arrival);
  void on(const Facts& facts, TimePoint) { facts_ = facts; }
  void on(const ActionStatus& status, TimePoint) { action_ = status; }
  void on(const ComponentHealth& health, TimePoint arrival) { permission_.on(health, arrival); }
  void on(const ExecutionStatus& status, TimePoint arrival) { permission_.on(status, arrival); }

  /// Facts have come: tasks can be judged.
  bool knows_world() const { return facts_.has_value(); }
  void step(TimePoint now, Outbox& out);

 private:
  struct Task {
    TaskGoal goal;
    TimePoint accepted{};
    TaskStatus status;
    std::vector<PlannedAction> actions;  // none while somebody to give to is looked for
    std::string home;                    // surface the object came from
    std::string failure;                 // set once an action failed; what is left only recovers
    bool begun{false};                   // the current action was sent
    std::uint64_t action{};
    TimePoint sent{};
  };
  void begin(const TaskGoal& goal, TimePoint now, Outbox& out);
  void look_for_person(TimePoint now, Outbox& out);
  void refuse(const TaskGoal& goal, const std::string& reason, Outbox& out);
  void control(const TaskGoal& goal, Outbox& out);
  void advance(TimePoint now, Outbox& out);
  void action_ended(Outbox& out);
  void report(Outbox& out);
  void finish(TaskState state, const std::string& reason, Outbox& out);

  config::SupervisorSettings settings_;
  Permission permission_;
  std::uint64_t next_action_;
  std::vector<TaskGoal> inbox_;
  std::optional<Facts> facts_;
  std::optional<ActionStatus> action_;
  std::optional<Task> task_;
  std::optional<TaskStatus> last_;
  std::vector<std::uint64_t> known_goals_;
  TimePoint go_sent_{}, status_sent_{};
  Go sent_go_;
  std::string phase_;
};

}  // namespace handsel::supervisor
