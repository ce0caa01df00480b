#include "components/supervisor/supervisor.hpp"

#include <algorithm>

namespace handsel::supervisor {
namespace {

constexpr std::size_t kMaxOrphans = 64, kMaxGoals = 64;
constexpr double kOrphanPatience = 5.0;  // [s]

}  // namespace

Supervisor::Supervisor(const config::SupervisorSettings& settings, Domain domain, Ability ability, std::uint64_t first_action,
                       const DurableState& restored, TimePoint now)
    : settings_(settings),
      domain_(std::move(domain)),
      permission_(settings),
      latches_(restored),
      lost_(settings.lost_after(), settings.max_lost_people(), restored.safety.lost, now),
      situation_(std::move(ability)),
      next_action_(first_action),
      inbox_(settings.has_max_goals() ? settings.max_goals() : kMaxGoals),
      stored_(restored.safety.revision) {}

Supervisor::Supervisor(const config::SupervisorSettings& settings, Domain domain, Ability ability, std::uint64_t first_action)
    : Supervisor(settings, std::move(domain), std::move(ability), first_action, fresh_state(first_action, settings.speed_override()), {}) {}

void Supervisor::on(const ComponentHealth& health, TimePoint arrival) {
  permission_.on(health, arrival);
  if (health.component == "spark") lost_.on_spark_started(arrival - from_seconds(health.uptime));
}

void Supervisor::on(const ExecutionStatus& status, TimePoint arrival) {
  permission_.on(status, arrival);
  latches_.on(status, permission_.acknowledged());
  if (permission_.missed_stop(latches_.permitted_at_start())) latches_.on_missed_stop();
}

void Supervisor::on(const TaskGoal& goal, TimePoint) {
  const bool turned_away = inbox_.put(goal) == GoalInbox::Admission::turned_away;
  if (turned_away && goal.kind == TaskKind::pause) latches_.pause();  // a person's wish to stop is never lost
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

/// A running task shows as paused while nothing may move because of a person, a fault, a stop, or attention.
void Supervisor::show_pause() {
  if (!task_ || task_->over() || (task_->status().state == TaskState::paused) == halted()) return;
  task_->pause(halted());
}

void Supervisor::suspend(bool suspended) {
  suspended_ = suspended;
  permission_.suspend(suspended);
  show_pause();
}

void Supervisor::control(const TaskGoal& goal, Outbox& out) {
  TaskStatus done;
  done.id = goal.id;
  done.kind = goal.kind;
  done.state = TaskState::succeeded;
  TaskWishes wishes;
  switch (goal.kind) {
    case TaskKind::pause:
      latches_.pause();
      suspend(false);
      report(out);
      break;
    case TaskKind::resume:
      if (const std::string why = latches_.resume(); !why.empty()) return refuse(goal, why, out);
      permission_.acknowledge();
      suspend(false);
      report(out);
      break;
    case TaskKind::cancel:
      if (!task_) return refuse(goal, "there is no task to cancel", out);
      task_->cancel(wishes);
      out.action_goals.insert(out.action_goals.end(), wishes.action_goals.begin(), wishes.action_goals.end());
      report(out);
      break;
    case TaskKind::acknowledge:
      if (const std::string why = latches_.acknowledge(); !why.empty()) return refuse(goal, why, out);
      permission_.acknowledge();
      show_pause();
      report(out);
      break;
    case TaskKind::speed:
      latches_.set_override(goal.value);
      break;
    case TaskKind::clear_person:  // SPARK heard it too
      lost_.clear(goal.human);
      break;
    default:
      break;
  }
  answers_.push_back({latches_.state().permission_revision, done});
}

/// Answers what a person has asked for, once it would survive the death of this process or cannot be stored.
void Supervisor::answer(Outbox& out) {
  std::erase_if(answers_, [&](const Answer& answer) {
    const bool due = stored_ >= answer.revision || store_failed_at_.has_value();
    if (due) out.task_statuses.push_back(answer.status);
    return due;
  });
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
      suspend(true);
      wishes.changed = true;
      break;
    case TaskChange::resume:
      if (!suspended_) break;
      suspend(false);
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
                      !inbox_.knows(action->task) && !orphans_.contains(action->task);
  if (!orphan) return orphan_since_.reset();
  if (!orphan_since_) orphan_since_ = now;
  if (to_seconds(now - *orphan_since_) < kOrphanPatience) return;
  orphans_.insert(action->task);
  if (orphans_.size() > kMaxOrphans) orphans_.erase(orphans_.begin());
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

void Supervisor::on_stored(std::uint64_t revision) {
  storing_ = false;
  stored_ = revision;
  store_failed_at_.reset();
  store_failure_.clear();
}

/// A record of people alone that could not be written stops nothing: no latch depends on it.
void Supervisor::on_store_failure(const std::string& reason, TimePoint now) {
  storing_ = false;
  store_failed_at_ = now;
  store_failure_ = reason;
  if (stored_ < latches_.state().permission_revision) latches_.on_store_failure(reason);
}

/// Keeps the durable state up to date: notes lost people, asks for what has changed to be stored, and publishes.
void Supervisor::keep(TimePoint now, Stamp stamp, Outbox& out) {
  const auto due = [&](const std::optional<TimePoint>& last, double period) { return !last || to_seconds(now - *last) >= period; };
  if (due(lost_noted_, settings_.lost_period()) && lost_.changed(now)) {
    latches_.set_lost(lost_.people(now), stamp);
    lost_noted_ = now;
  }
  const std::uint64_t revision = latches_.safety().revision;
  if (revision != stored_ && !storing_ && due(store_failed_at_, settings_.store_retry())) {
    out.store = latches_.state();
    storing_ = true;
  }
  if (revision == published_ && !due(safety_sent_, settings_.safety_period())) return;
  out.safety = latches_.safety();
  out.safety->stamp = stamp;
  out.safety->lost = lost_.people(now);
  published_ = revision;
  safety_sent_ = now;
}

void Supervisor::send_go(const Go& go, TimePoint now, Outbox& out) {
  const bool changed = go.epoch != sent_go_.epoch || go.allowed != sent_go_.allowed || go.override_factor != sent_go_.override_factor ||
                       go.state_revision != sent_go_.state_revision;
  if (!changed && to_seconds(now - go_sent_) < 0.99 * settings_.go_period()) return;
  out.go = go;
  sent_go_ = go;
  go_sent_ = now;
}

void Supervisor::step(TimePoint now, Stamp stamp, Outbox& out) {
  for (const auto& goal : inbox_.take()) {
    if (is_control(goal.kind))
      control(goal, out);
    else if (!begin(goal, now, out))
      inbox_.put_back(goal);
  }
  for (const auto& goal : inbox_.take_turned_away())
    if (goal.kind == TaskKind::pause)
      control(goal, out);
    else
      refuse(goal, std::to_string(inbox_.max()) + " goals wait already, which is the limit; ask again later", out);
  const SafetyState& safety = latches_.safety();
  const bool stored = stored_ >= latches_.state().permission_revision;
  const Go go =
      permission_.step({latches_.state().permission_revision, latches_.permits(), stored, safety.override_factor, safety.reason}, now);
  TaskWishes wishes;
  heed(now, wishes);
  if (task_ && (task_->status().state == TaskState::paused) != halted()) {
    show_pause();
    wishes.changed = true;
  }
  if (task_) {
    task_->step(now, permission_.missing(), sent_go_.epoch, next_action_, wishes);
    out.action_goals.insert(out.action_goals.end(), wishes.action_goals.begin(), wishes.action_goals.end());
    if (wishes.changed || task_->over()) report(out);
  }
  look_for_orphan(now, out);
  send_go(go, now, out);
  keep(now, stamp, out);
  answer(out);
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
