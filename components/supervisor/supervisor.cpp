#include "components/supervisor/supervisor.hpp"

#include <algorithm>

namespace handsel::supervisor {
namespace {

constexpr std::size_t kRememberedGoals = 256;
constexpr double kOrphanPatience = 5.0;  // [s]

bool is_control(TaskKind kind) { return kind >= TaskKind::pause; }

}  // namespace

Supervisor::Supervisor(const config::SupervisorSettings& settings, Domain domain, Ability ability, std::uint64_t first_action)
    : settings_(settings), domain_(std::move(domain)), permission_(settings), situation_(std::move(ability)), next_action_(first_action) {}

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
  status.reason = cut(reason, kMostReason);
  out.task_statuses.push_back(status);
  if (!task_) last_ = status;
}

/// False: it cannot be said yet.
bool Supervisor::begin(const TaskGoal& goal, TimePoint now, Outbox& out) {
  if (task_) {
    refuse(goal, "the robot is busy: " + text_of(task_->goal()) + "; wait for its end or cancel it first", out);
    return true;
  }
  if (!situation_.known()) {
    refuse(goal, "the state of the world is not known yet", out);
    return true;
  }
  auto task = std::make_unique<TaskRun>(settings_, domain_, situation_, goal, now);
  switch (task->start(now)) {
    case TaskRun::Start::unsure:
      return false;
    case TaskRun::Start::refused:
      refuse(goal, task->status().reason, out);
      return true;
    case TaskRun::Start::begun:
      break;
  }
  task_ = std::move(task);
  report(out);
  return true;
}

void Supervisor::pause(bool paused) {
  permission_.pause(paused);
  if (task_) task_->pause(paused);
}

void Supervisor::control(const TaskGoal& goal, Outbox& out) {
  TaskStatus done;
  done.id = goal.id;
  done.kind = goal.kind;
  done.state = TaskState::succeeded;
  TaskWishes wishes;
  switch (goal.kind) {
    case TaskKind::pause:
    case TaskKind::resume:
      pause(goal.kind == TaskKind::pause);
      paused_by_attention_ = false;
      report(out);
      break;
    case TaskKind::cancel:
      if (!task_) return refuse(goal, "there is no task to cancel", out);
      task_->cancel(wishes);
      out.action_goals.insert(out.action_goals.end(), wishes.action_goals.begin(), wishes.action_goals.end());
      report(out);
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

/// What attention wants of the task, once each time it begins to want it.
void Supervisor::heed(TimePoint now, TaskWishes& wishes) {
  if (!task_ || advice_.change == heeded_) {
    if (!task_) heeded_ = TaskChange::none;
    return;
  }
  switch (advice_.change) {
    case TaskChange::none:
      break;
    case TaskChange::suspend:
      if (task_->status().state != TaskState::running) break;
      pause(true);
      paused_by_attention_ = wishes.changed = true;
      break;
    case TaskChange::resume:
      if (!std::exchange(paused_by_attention_, false)) break;
      pause(false);
      wishes.changed = true;
      break;
    case TaskChange::abort:
      task_->abort(advice_.person.empty() ? "given up for people's sake" : "given up because of " + advice_.person, now, wishes);
      break;
    case TaskChange::give:
      if (!task_->give_instead(advice_.person, now, wishes)) return;  // perhaps soon
      break;
  }
  heeded_ = advice_.change;
}

/// This process was started anew while an action ran, and nobody asks for its task again.
void Supervisor::look_for_orphan(TimePoint now, Outbox& out) {
  const auto& action = situation_.action();
  const bool orphan = !task_ && inbox_.empty() && action && action->state == ActionState::running && action->task != 0 &&
                      std::find(known_goals_.begin(), known_goals_.end(), action->task) == known_goals_.end() &&
                      !orphans_.contains(action->task);
  if (!orphan) return orphan_since_.reset();
  if (!orphan_since_) orphan_since_ = now;
  if (to_seconds(now - *orphan_since_) < kOrphanPatience) return;
  orphans_.insert(action->task);
  TaskStatus status;
  status.id = action->task;
  status.state = TaskState::failed;
  status.reason = "the supervisor was started anew while this task ran, and nobody asked for it again; its last action runs to its end";
  out.task_statuses.push_back(status);
  last_ = status;
}

void Supervisor::report(Outbox& out) {
  if (!task_) return;
  out.task_statuses.push_back(task_->status());
  if (!task_->over()) return;
  last_ = task_->status();
  task_.reset();
}

void Supervisor::step(TimePoint now, Outbox& out) {
  const Go& go = permission_.step(now);
  std::vector<TaskGoal> later;
  for (const auto& goal : std::exchange(inbox_, {})) {
    if (is_control(goal.kind))
      control(goal, out);
    else if (!begin(goal, now, out))
      later.push_back(goal);
  }
  inbox_ = std::move(later);
  TaskWishes wishes;
  heed(now, wishes);
  if (task_) {
    task_->step(now, permission_.missing().empty(), sent_go_.epoch, next_action_, wishes);
    out.action_goals.insert(out.action_goals.end(), wishes.action_goals.begin(), wishes.action_goals.end());
    if (wishes.changed || task_->over()) report(out);
  }
  look_for_orphan(now, out);

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
