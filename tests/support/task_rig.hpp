// SPDX-License-Identifier: Apache-2.0
// A supervisor in a symbolic world of facts that emulates the rest of the system.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "common/config/resources.hpp"
#include "components/supervisor/supervisor.hpp"
#include "tests/support/task_world.hpp"

namespace handsel::supervisor {

inline settings::SupervisorSettings rig_settings() {
  auto s = settings::read_supervisor_settings(resource("config/supervisor.txtpb"));
  s.required = {"spark"};
  s.resume_delay = 0.1;
  s.person_timeout = 2.0;
  s.missing_timeout = 5.0;
  return s;
}

/// How an action fails; without a reason it does not.
struct Failure {
  std::string reason;
  ActionFailure kind{ActionFailure::other};
  Failure(const char* why = "", ActionFailure of = ActionFailure::other) : reason(why), kind(of) {}
};

/// Emulates the rest of the system: SPARK reports the facts of `world`, the controller obeys Go,
/// the manipulation planner takes `action_time` per action and fails as `fails` states, unless the
/// test ends actions itself.
class TaskRig {
 public:
  explicit TaskRig(bool by_hand = false, const Ability& ability = {})
      : supervisor(rig_settings(), load_domain(resource("config/tasks.txtpb")), ability, 100),
        by_hand_(by_hand) {
    world.on["mug"] = "table";
    world.people["anna"] = true;
  }

  void run(double duration) {
    for (double t = 0; t < duration; t += 0.02) cycle();
  }
  /// Until the task is over; false: it is not after a minute.
  bool finish() {
    for (int i = 0; i < 3000; ++i) {
      cycle();
      if (!statuses.empty() && is_end(last().state)) return true;
    }
    return false;
  }
  static bool is_end(TaskState state) { return state >= TaskState::succeeded; }

  void ask(TaskKind kind, const std::string& object = "", const std::string& human = "",
           const std::string& surface = "", const std::string& onto = "") {
    supervisor.on(TaskGoal{.id = ++ids,
                           .kind = kind,
                           .object = object,
                           .human = human,
                           .surface = surface,
                           .onto = onto},
                  now);
  }
  void give(std::uint64_t id, const std::string& to = "anna") {
    TaskGoal goal;
    goal.id = id;
    goal.kind = TaskKind::give;
    goal.object = "mug";
    goal.human = to;
    supervisor.on(goal, now);
  }

  void advise(TaskChange change, const std::string& person = "") {
    AttentionAdvice advice;
    advice.change = change;
    advice.person = person;
    supervisor.on(advice, now);
  }

  void end_action(ActionState state, const std::string& reason = "") {
    action.state = state;
    action.reason = reason;
    if (state == ActionState::succeeded)
      world.perform(goals.back().kind, goals.back().object, goals.back().human,
                    goals.back().surface);
    run(0.1);
  }

  const TaskStatus& last() const { return statuses.back(); }
  std::string done() const {
    std::string out;
    std::uint64_t before = 0;
    for (const ActionGoal& goal : goals) {
      if (goal.cancel || goal.id == before) continue;
      before = goal.id;
      out += (out.empty() ? "" : ", ") +
             PlannedAction{goal.kind, goal.object, goal.human, goal.surface, -1, {}, 0}.text();
    }
    return out;
  }
  std::string line(const std::string& text) const {
    std::string out = "no line \"" + text + "\"";
    for (const PlanStep& step : last().tree)
      if (step.text == text)
        out = std::string(name(step.state)) + (step.reason.empty() ? "" : ": " + step.reason);
    return out;
  }

  TaskWorld world;
  TimePoint now{};
  Supervisor supervisor;
  ExecutionStatus execution;
  ActionStatus action;
  bool spark_alive{true}, planner_alive{true};
  double action_time{1.0};
  std::function<Failure(const ActionGoal&)> fails;
  Go go;
  SafetyState safety;
  std::vector<ActionGoal> goals;
  std::vector<TaskStatus> statuses;
  std::uint64_t ids{1000};

 private:
  void cycle() {
    now += from_seconds(0.02);
    if (spark_alive) {
      ComponentHealth health;
      health.component = "spark";
      health.state = HealthState::ok;
      supervisor.on(health, now);
      supervisor.on(world.scene(), now);
      supervisor.on(world.facts(), now);
    }
    supervisor.on(execution, now);
    act();
    if (planner_alive) supervisor.on(action, now);
    Outbox out;
    supervisor.step(now, 0, out);
    if (out.store) supervisor.on_stored(out.store->safety.revision);
    if (out.safety) safety = *out.safety;
    if (out.go) {
      go = *out.go;
      const bool resumes = go.allowed && go.epoch > execution.epoch &&
                           (execution.mode != Mode::fault || go.acknowledge);
      execution.mode = resumes      ? Mode::normal
                       : go.allowed ? execution.mode
                                    : std::max(execution.mode, Mode::hold);
      execution.epoch = go.epoch;
    }
    for (const auto& goal : out.action_goals) {
      goals.push_back(goal);
      if (planner_alive) take(goal);
    }
    for (auto& status : out.task_statuses) statuses.push_back(status);
  }
  void take(const ActionGoal& goal) {
    if (goal.cancel) {
      if (goal.id == action.id && action.state == ActionState::running)
        action.state = ActionState::cancelled;
      return;
    }
    if (goal.id == action.id) return;
    action = {};
    action.id = goal.id;
    action.task = goal.task;
    action.kind = goal.kind;
    action.object = goal.object;
    action.human = goal.human;
    action.state = ActionState::running;
    current_ = goal;
    begun_ = now;
  }
  void act() {
    if (by_hand_ || !planner_alive || !go.allowed || action.state != ActionState::running ||
        to_seconds(now - begun_) < action_time)
      return;
    const Failure failure = fails ? fails(current_) : Failure();
    action.reason = failure.reason;
    action.failure = failure.reason.empty() ? ActionFailure::none : failure.kind;
    if (action.reason.empty() &&
        !world.perform(current_.kind, current_.object, current_.human, current_.surface))
      action.reason = "it cannot be done here", action.failure = ActionFailure::other;
    action.state = action.reason.empty() ? ActionState::succeeded : ActionState::failed;
  }
  bool by_hand_;
  ActionGoal current_;
  TimePoint begun_{};
};

}  // namespace handsel::supervisor
