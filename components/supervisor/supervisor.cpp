// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/supervisor.hpp"

#include <memory>

namespace handsel::supervisor {
namespace {

constexpr std::size_t kMaxGoals = 64;  // max number of waiting goals

}  // namespace

Supervisor::Supervisor(const settings::SupervisorSettings& settings, Domain domain, Ability ability,
                       std::uint64_t first_action, const DurableState& restored, TimePoint now)
    : settings_(settings),
      domain_(std::move(domain)),
      permission_(settings),
      go_sender_(settings.go_period),
      latches_(restored),
      lost_(settings.lost_after, settings.max_lost_people, restored.safety.lost, now),
      keeper_(settings, restored.safety.revision),
      situation_(std::move(ability)),
      next_action_(first_action),
      inbox_(settings.max_goals),
      orphans_(settings.orphan_timeout) {}

Supervisor::Supervisor(const settings::SupervisorSettings& settings, Domain domain, Ability ability,
                       std::uint64_t first_action)
    : Supervisor(settings, std::move(domain), std::move(ability), first_action,
                 fresh_state(first_action, settings.speed_override), {}) {}

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
  if (turned_away && goal.kind == TaskKind::pause)
    latches_.pause();  // a pause by a person always takes effect
}

/// Executes a goal; returns false if the goal cannot be evaluated yet.
bool Supervisor::begin(const TaskGoal& goal, TimePoint now, Outbox& out) {
  if (TaskRun* running = slot_.task(); running != nullptr) {
    slot_.refuse(
        goal,
        "the robot is busy: " + text_of(running->goal()) + "; wait for its end or cancel it first",
        out.task_statuses);
    return true;
  }
  if (!situation_.known()) {
    slot_.refuse(goal, "the state of the world is not known yet", out.task_statuses);
    return true;
  }
  auto task = std::make_unique<TaskRun>(settings_, domain_, situation_, goal, now);
  switch (task->start(now)) {
    case TaskRun::Start::unsure:
      return false;
    case TaskRun::Start::refused:
      slot_.refuse(goal, task->status().reason, out.task_statuses);
      return true;
    case TaskRun::Start::begun:
      break;
  }
  slot_.begin(std::move(task), out.task_statuses);
  return true;
}

void Supervisor::suspend(bool suspended) {
  suspended_ = suspended;
  permission_.suspend(suspended);
  slot_.show_pause(halted());
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
      slot_.report(out.task_statuses);
      break;
    case TaskKind::resume:
      if (const std::string why = latches_.resume(); !why.empty())
        return slot_.refuse(goal, why, out.task_statuses);
      permission_.acknowledge();
      suspend(false);
      slot_.report(out.task_statuses);
      break;
    case TaskKind::cancel:
      if (slot_.task() == nullptr)
        return slot_.refuse(goal, "there is no task to cancel", out.task_statuses);
      slot_.task()->cancel(wishes);
      out.action_goals.insert(out.action_goals.end(), wishes.action_goals.begin(),
                              wishes.action_goals.end());
      slot_.report(out.task_statuses);
      break;
    case TaskKind::acknowledge:
      if (const std::string why = latches_.acknowledge(); !why.empty())
        return slot_.refuse(goal, why, out.task_statuses);
      permission_.acknowledge();
      slot_.show_pause(halted());
      slot_.report(out.task_statuses);
      break;
    case TaskKind::speed:
      latches_.set_override(goal.value);
      break;
    case TaskKind::clear_person:  // SPARK also receives the goal
      lost_.clear(goal.human);
      break;
    default:
      break;
  }
  keeper_.answer_when_stored(latches_.state().permission_revision, done);
}

/// Changes the task by the advice of attention, once per change of the advice.
void Supervisor::follow_advice(TimePoint now, TaskWishes& wishes) {
  TaskRun* task = slot_.task();
  if (task == nullptr || advice_.change == followed_) {
    if (task == nullptr) followed_ = TaskChange::none;
    return;
  }
  switch (advice_.change) {
    case TaskChange::none:
      break;
    case TaskChange::suspend:
      if (task->status().state != TaskState::running) break;
      suspend(true);
      wishes.changed = true;
      break;
    case TaskChange::resume:
      if (!suspended_) break;
      suspend(false);
      wishes.changed = true;
      break;
    case TaskChange::abort:
      task->abort(advice_.person.empty() ? "given up for people's sake"
                                         : "given up because of " + advice_.person,
                  now, wishes);
      break;
    case TaskChange::give:
      // Tried again in the next cycle.
      if (!task->give_instead(advice_.person, now, wishes)) return;
      break;
  }
  followed_ = advice_.change;
}

/// Returns the task of the running action if there is no goal for this task.
std::optional<std::uint64_t> Supervisor::unasked_task() const {
  const auto& action = situation_.action();
  const bool unasked = slot_.task() == nullptr && inbox_.empty() && action &&
                       action->state == ActionState::running && action->task != 0 &&
                       !inbox_.knows(action->task);
  return unasked ? std::optional(action->task) : std::nullopt;
}

/// A failure to store only people does not stop the robot, because no latch depends on people.
void Supervisor::on_store_failure(const std::string& reason, TimePoint now) {
  keeper_.on_store_failure(reason, now);
  if (!keeper_.is_stored(latches_.state().permission_revision)) latches_.on_store_failure(reason);
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
      slot_.refuse(
          goal,
          std::to_string(inbox_.max()) + " goals wait already, which is the limit; ask again later",
          out.task_statuses);
  const SafetyState& safety = latches_.safety();
  const std::uint64_t revision = latches_.state().permission_revision;
  const Go go = permission_.step({revision, latches_.permits(), keeper_.is_stored(revision),
                                  safety.override_factor, safety.reason},
                                 now);
  TaskWishes wishes;
  follow_advice(now, wishes);
  if (slot_.show_pause(halted())) wishes.changed = true;
  if (TaskRun* task = slot_.task(); task != nullptr) {
    task->step(now, permission_.missing(), go_sender_.epoch(), next_action_, wishes);
    out.action_goals.insert(out.action_goals.end(), wishes.action_goals.begin(),
                            wishes.action_goals.end());
    if (wishes.changed || task->over()) slot_.report(out.task_statuses);
  }
  if (const auto orphan = orphans_.step(unasked_task(), now))
    slot_.report_end(*orphan, out.task_statuses);
  if (const auto due = go_sender_.step(go, now)) out.go = due;
  StateOutput state = keeper_.step(now, stamp, latches_, lost_);
  if (state.store) out.store = std::move(state.store);
  if (state.safety) out.safety = std::move(state.safety);
  keeper_.take_answers(out.task_statuses);
  slot_.repeat(now, settings_.status_period, out.task_statuses);
}

}  // namespace handsel::supervisor
