#include "components/supervisor/supervisor.hpp"

#include <algorithm>

namespace handsel::supervisor {
namespace {

constexpr std::size_t kRememberedGoals = 256;
constexpr std::size_t kMostRefusals = 64;

bool is_control(TaskKind kind) { return kind >= TaskKind::pause; }

}  // namespace

Supervisor::Supervisor(const config::SupervisorSettings& settings, std::uint64_t first_action)
    : settings_(settings), permission_(settings), next_action_(first_action) {}

void Supervisor::on(const TaskGoal& goal, TimePoint) {
  if (std::find(known_goals_.begin(), known_goals_.end(), goal.id) != known_goals_.end()) return;
  known_goals_.push_back(goal.id);
  if (known_goals_.size() > kRememberedGoals) known_goals_.erase(known_goals_.begin());
  inbox_.push_back(goal);
}

void Supervisor::refuse(const TaskGoal& goal, const std::string& reason, Outbox& out) {
  TaskStatus status;
  status.id = goal.id;
  status.kind = goal.kind;
  status.state = TaskState::refused;
  status.reason = reason;
  out.task_statuses.push_back(status);
  if (!task_) last_ = status;
}

void Supervisor::begin(const TaskGoal& goal, TimePoint now, Outbox& out) {
  if (task_) return refuse(goal, "busy with task " + std::to_string(task_->status.id) + "; cancel it first", out);
  if (!facts_) return refuse(goal, "the state of the world is not known yet", out);
  TaskPlan plan = plan_task(goal, *facts_);
  if (!plan.reason.empty()) return refuse(goal, plan.reason, out);
  Task task;
  task.goal = goal;
  task.accepted = now;
  task.status.id = goal.id;
  task.status.kind = goal.kind;
  task.status.state = TaskState::running;
  for (const auto& action : plan.actions) task.status.plan.push_back(action.text());
  if (plan.needs_person)
    task.status.phase = "looking for somebody";
  else
    task.actions = std::move(plan.actions);
  for (const auto& fact : facts_->facts)
    if (fact.kind == FactKind::on_surface && fact.subject == goal.object) task.home = fact.object;
  task_ = std::move(task);
  report(out);
}

void Supervisor::look_for_person(TimePoint now, Outbox& out) {
  TaskPlan plan = plan_task(task_->goal, *facts_);
  if (plan.needs_person) {
    if (to_seconds(now - task_->accepted) >= settings_.person_timeout())
      finish(TaskState::failed, "nobody is in sight to give " + task_->goal.object + " to", out);
    return;
  }
  if (!plan.reason.empty()) return finish(TaskState::failed, plan.reason, out);
  task_->status.plan.clear();
  for (const auto& action : plan.actions) task_->status.plan.push_back(action.text());
  task_->actions = std::move(plan.actions);
}

void Supervisor::control(const TaskGoal& goal, Outbox& out) {
  TaskStatus done;
  done.id = goal.id;
  done.kind = goal.kind;
  done.state = TaskState::succeeded;
  switch (goal.kind) {
    case TaskKind::pause:
    case TaskKind::resume:
      permission_.pause(goal.kind == TaskKind::pause);
      if (task_) {
        task_->status.state = goal.kind == TaskKind::pause ? TaskState::paused : TaskState::running;
        report(out);
      }
      break;
    case TaskKind::cancel:
      if (!task_) return refuse(goal, "there is no task to cancel", out);
      if (task_->begun) {
        ActionGoal stop;
        stop.id = task_->action;
        stop.cancel = true;
        out.action_goals.push_back(stop);
      }
      finish(TaskState::cancelled, "cancelled on request", out);
      break;
    case TaskKind::acknowledge:
      permission_.acknowledge();
      break;
    case TaskKind::speed:
      permission_.set_override(std::clamp(goal.value, 0.0, 1.0));
      break;
    default:  // clear_person: SPARK heard it too
      break;
  }
  out.task_statuses.push_back(done);
}

void Supervisor::report(Outbox& out) {
  if (task_) out.task_statuses.push_back(task_->status);
}

void Supervisor::finish(TaskState state, const std::string& reason, Outbox& out) {
  task_->status.state = state;
  task_->status.reason = reason;
  report(out);
  last_ = task_->status;
  task_.reset();
}

void Supervisor::action_ended(Outbox& out) {
  Task& task = *task_;
  for (const auto& refusal : action_->refusals)
    if (task.status.refusals.size() < kMostRefusals) task.status.refusals.push_back(refusal);
  task.begun = false;
  const bool good = action_->state == ActionState::succeeded;
  if (!good) {
    const PlannedAction failed = task.actions[task.status.step];
    const bool recovering = !task.failure.empty();
    if (!recovering) task.failure = failed.text() + ": " + action_->reason;
    task.actions.resize(task.status.step + 1);
    task.status.plan.resize(task.status.step + 1);
    if (!recovering) {
      for (const auto& action : recover(failed, action_->holding, task.home)) {
        task.actions.push_back(action);
        task.status.plan.push_back(action.text());
      }
    }
  }
  if (task.status.step + 1 < task.actions.size()) {
    ++task.status.step;
    task.status.phase.clear();
    report(out);
    return;
  }
  finish(task.failure.empty() ? TaskState::succeeded : TaskState::failed, task.failure, out);
}

void Supervisor::advance(TimePoint now, Outbox& out) {
  Task& task = *task_;
  if (task.status.state == TaskState::paused) return;
  if (task.actions.empty()) return look_for_person(now, out);
  if (!task.begun) {
    if (!permission_.missing().empty()) return;
    task.begun = true;
    task.action = ++next_action_;
    task.sent = {};
  }
  if (action_ && action_->id == task.action) {
    if (action_->state != ActionState::running) return action_ended(out);
    if (task.status.phase != action_->phase) {
      task.status.phase = action_->phase;
      report(out);
    }
    return;
  }
  if (to_seconds(now - task.sent) < settings_.goal_retry()) return;
  const PlannedAction& action = task.actions[task.status.step];
  ActionGoal goal;
  goal.id = task.action;
  goal.task = task.status.id;
  goal.epoch = sent_go_.epoch;
  goal.kind = action.kind;
  goal.object = action.object;
  goal.human = action.human;
  goal.surface = action.surface;
  out.action_goals.push_back(goal);
  task.sent = now;
}

void Supervisor::step(TimePoint now, Outbox& out) {
  const Go& go = permission_.step(now);
  for (const auto& goal : std::exchange(inbox_, {})) is_control(goal.kind) ? control(goal, out) : begin(goal, now, out);
  if (task_) advance(now, out);

  const bool changed = go.epoch != sent_go_.epoch || go.allowed != sent_go_.allowed || go.override_factor != sent_go_.override_factor;
  if (changed || to_seconds(now - go_sent_) >= 0.99 * settings_.go_period()) {
    out.go = go;
    sent_go_ = go;
    go_sent_ = now;
  }
  if (!out.task_statuses.empty()) {
    status_sent_ = now;
  } else if (to_seconds(now - status_sent_) >= settings_.status_period()) {
    if (task_)
      report(out);
    else if (last_)
      out.task_statuses.push_back(*last_);
    status_sent_ = now;
  }
}

}  // namespace handsel::supervisor
