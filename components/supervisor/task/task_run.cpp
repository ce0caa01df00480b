// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/task_run.hpp"

#include <algorithm>
#include <cmath>

#include "common/messages/names.hpp"

namespace handsel::supervisor {
namespace {

constexpr std::size_t kMaxRefusals = 64;  // max number of stored refusals
constexpr const char* kRunsActions = "manipulation_planner";

bool only_rests(const Plan& plan) {
  return std::all_of(plan.actions.begin(), plan.actions.end(),
                     [](const PlannedAction& a) { return a.kind == ActionKind::go_to; });
}

/// Returns the receiver of the held object in the plan of a recovery, for people; empty: none.
std::string fate_of_held(const Plan& plan) {
  std::string text;
  for (const PlannedAction& action : plan.actions) {
    if (action.kind == ActionKind::give)
      text += "; " + action.object + " was handed to " + action.human;
  }
  return text;
}

TaskGoal normal(TaskGoal goal) {
  const bool ends_somewhere = goal.kind == TaskKind::receive || goal.kind == TaskKind::tidy;
  if (ends_somewhere && goal.onto.empty()) goal.onto = goal.surface;
  return goal;
}

std::string object_of(const PlannedAction& action, Situation& situation) {
  const bool of_held = action.object.empty() && action.kind != ActionKind::receive &&
                       action.kind != ActionKind::go_to && action.kind != ActionKind::drive;
  return of_held ? situation.held() : action.object;
}

bool is_drive_to_place(const ActionGoal& goal) {
  return goal.kind == ActionKind::drive && goal.object.empty() && goal.human.empty() &&
         goal.surface.empty();
}

}  // namespace

TaskRun::TaskRun(const settings::SupervisorSettings& settings, const Domain& domain,
                 Situation& situation, const TaskGoal& goal, TimePoint now)
    : settings_(settings),
      situation_(situation),
      problem_(settings, domain, situation, normal(goal)),
      effects_(domain, settings.effect_timeout),
      dispatch_(settings.goal_retry),
      failures_(settings),
      accepted_(now) {
  status_.id = goal.id;
  status_.kind = goal.kind;
  status_.state = TaskState::running;
}

const TaskStatus& TaskRun::status() {
  progress_.write(problem_.text(), status_);
  status_.phase = cut(status_.phase, kMaxPhase);
  status_.reason = cut(status_.reason, kMaxReason);
  PlanStep& root = status_.tree.front();
  root.reason = status_.reason;
  switch (status_.state) {
    case TaskState::succeeded:
      root.state = StepState::done;
      break;
    case TaskState::failed:
    case TaskState::refused:
      root.state = StepState::failed;
      break;
    case TaskState::cancelled:
      root.state = StepState::dropped;
      break;
    default:
      root.state = StepState::running;
  }
  return status_;
}

TaskRun::Start TaskRun::start(TimePoint now) {
  const TaskGoal& goal = problem_.goal();
  TaskQuery query = problem_.resolve(goal);
  status_.reason = query.reason;
  const bool young = situation_.known_for(now) < settings_.sight_timeout;
  const bool person = !query.unseen.empty() && query.unseen == goal.human;
  if (person && situation_.met(goal.human)) query.needs_person = true;
  problem_.set_query(query);
  if (!query.reason.empty() && !query.needs_person)
    return !query.unseen.empty() && young ? Start::unsure : Start::refused;
  status_.reason.clear();
  if (query.needs_person) {
    status_.phase = "looking for " + (goal.human.empty() ? "somebody" : goal.human);
    return Start::begun;
  }
  Plan plan = plan_from(situation_.world().state);
  if (plan.found && !left_out(plan).empty() && only_rests(plan)) {
    plan.found = false;
    plan.reason = left_out(plan);
  }
  if (!plan.found) {
    status_.reason = plan.reason;
    return young ? Start::unsure : Start::refused;
  }
  if (plan.actions.empty()) {
    progress_.adopt(std::move(plan), {});
    finish(TaskState::succeeded, already(goal));
    return Start::begun;
  }
  adopt(std::move(plan));
  return Start::begun;
}

void TaskRun::adopt(Plan plan) {
  progress_.adopt(std::move(plan),
                  [this](const PlannedAction& action) { return problem_.why_dropped(action); });
  stage_ = Stage::planned;
}

Plan TaskRun::plan_from(const State& state) const {
  return failures_.recovering() ? problem_.recovery(state) : problem_.plan(state);
}

bool TaskRun::replan(TimePoint now) {
  if (++replans_ > settings_.max_replans) return false;
  if (!failures_.recovering()) {
    const TaskQuery query = problem_.resolve(problem_.goal());
    if (query.reason.empty()) problem_.set_query(query);
  }
  Plan plan = plan_from(believed(now));
  if (!plan.found) {
    status_.reason = plan.reason;
    return false;
  }
  status_.reason.clear();
  adopt(std::move(plan));
  hopeless_.reset();
  obsolete_.reset();
  return true;
}

void TaskRun::say(const std::string& phase, TaskWishes& wishes) {
  if (status_.phase == phase) return;
  status_.phase = phase;
  wishes.changed = true;
}

void TaskRun::finish(TaskState state, const std::string& reason) {
  status_.state = state;
  status_.reason = reason;
  stage_ = Stage::over;
}

void TaskRun::search(TimePoint now, TaskWishes& wishes) {
  const TaskQuery query = problem_.resolve(problem_.goal());
  if (query.reason.empty() && !query.needs_person) {
    problem_.set_query(query);
    status_.phase.clear();
    wishes.changed = true;
    if (!replan(now)) finish(TaskState::failed, status_.reason);
    return;
  }
  const bool person = query.needs_person || query.unseen == problem_.goal().human;
  if (person && to_seconds(now - accepted_) < settings_.person_timeout) return;
  wishes.changed = true;
  finish(TaskState::failed,
         query.needs_person ? "nobody is in sight to " + problem_.text() : query.reason);
}

/// Ends the task if a required component stays missing, unless the running action can end without
/// it.
bool TaskRun::is_stranded(TimePoint now, const std::vector<std::string>& missing) {
  const bool long_missing = missing_.lasts(!missing.empty(), now, settings_.missing_timeout);
  return long_missing && (dispatch_.state() == ActionDispatch::State::idle ||
                          std::find(missing.begin(), missing.end(), kRunsActions) != missing.end());
}

void TaskRun::step(TimePoint now, const std::vector<std::string>& missing, std::uint64_t go_epoch,
                   std::uint64_t& next_id, TaskWishes& wishes) {
  if (over() || status_.state == TaskState::paused || !situation_.known()) return;
  if (is_stranded(now, missing)) {
    wishes.changed = true;
    const std::string timeout = std::to_string(std::lround(settings_.missing_timeout)) + " s";
    return finish(TaskState::failed, missing.front() + " has not been there for " + timeout);
  }
  if (stage_ == Stage::searching) return search(now, wishes);
  if (dispatch_.state() != ActionDispatch::State::idle)
    return follow(now, go_epoch, next_id, wishes);
  if (now < not_before_ || !missing.empty()) return;
  if (progress_.current() == nullptr) {
    wishes.changed = true;
    return all_done(now);
  }
  const std::string impossible = problem_.why_impossible(progress_.left(), believed(now));
  if (!impossible.empty()) {
    wishes.changed = true;
    const bool other = hopeless_.holds() ? false : replan(now);
    if (other) return;
    // Facts may alternate; the condition must hold for a time before the task is given up.
    if (hopeless_.lasts(true, now, settings_.settle_time)) {
      hopeless_.reset();
      if (!replan(now)) give_up(status_.reason.empty() ? impossible : status_.reason, now);
    }
    return;
  }
  hopeless_.reset();
  send(now, go_epoch, next_id, wishes);
  wishes.changed = true;
}

/// Monitors the started action: its reports and end; repeats its goal until the first report.
void TaskRun::follow(TimePoint now, std::uint64_t go_epoch, std::uint64_t& next_id,
                     TaskWishes& wishes) {
  const auto& action = situation_.action();
  const bool reported = dispatch_.reports(action);
  if (reported && action->state != ActionState::running) {
    wishes.changed = true;
    ended(now);
  } else if (dispatch_.state() == ActionDispatch::State::stopping) {
    // A restarted planner does not know the action.
    if (!reported && dispatch_.retry_due(now)) ended(now);
  } else {
    watch(now, wishes);
    if (over() || dispatch_.state() == ActionDispatch::State::stopping) return;
    if (reported) return say(phase_text(*action), wishes);
    if (dispatch_.retry_due(now)) send(now, go_epoch, next_id, wishes);
  }
}

void TaskRun::send(TimePoint now, std::uint64_t go_epoch, std::uint64_t& next_id,
                   TaskWishes& wishes) {
  const PlannedAction& planned = *progress_.current();
  ActionGoal goal;
  goal.kind = planned.kind;
  goal.object = object_of(planned, situation_);
  goal.human = planned.human;
  goal.surface = planned.surface;
  goal.both_hands = planned.both_hands;
  goal.task = status_.id;
  goal.epoch = go_epoch;
  if (is_drive_to_place(goal)) {
    const Vector3& place = problem_.goal().place;
    goal.has_goal = true;
    goal.T_world_goal =
        make_pose({place.x(), place.y(), 0},
                  Eigen::Quaterniond(Eigen::AngleAxisd(place.z(), Vector3::UnitZ())));
  }
  if (dispatch_.state() == ActionDispatch::State::idle) {
    broken_.reset();
    obsolete_.reset();
    status_.phase.clear();
    progress_.begin();
    problem_.note_home(goal.object);
    if (dispatch_.begin(goal, situation_.action(), next_id)) return;
  }
  dispatch_.send(goal, now, wishes.action_goals);
}

/// Checks whether the running action and the following actions are still valid.
void TaskRun::watch(TimePoint now, TaskWishes& wishes) {
  const PlannedAction& running = *progress_.current();
  const std::string why = problem_.why_broken(running);
  // A person who has the only object of the task may put it down again.
  const bool may_come_back = running.kind == ActionKind::pick &&
                             running.object == problem_.goal().object &&
                             !situation_.person_with(running.object).empty();
  const double max_invalid = may_come_back ? settings_.taken_timeout : settings_.settle_time;
  if (broken_.lasts(!why.empty(), now, max_invalid)) {
    const std::string fate = running.object.empty() ? "" : situation_.fate_of(running.object);
    dispatch_.stop(fate.empty() ? why : fate, now, wishes.action_goals);
    return;
  }
  const std::vector<PlannedAction> later = progress_.left(true);
  if (later.empty()) return;
  const State after = problem_.after(running);
  const bool obsolete = !problem_.why_impossible(later, after).empty();
  if (!obsolete_.lasts(obsolete, now, settings_.settle_time)) return;
  obsolete_.reset();
  if (replans_ >= settings_.max_replans) return;
  Plan plan = plan_from(after);
  if (!plan.found) return;  // evaluated again at the end of this action
  ++replans_;
  progress_.adopt_after_running(std::move(plan), [this](const PlannedAction& action) {
    return problem_.why_replaced(action);
  });
  wishes.changed = true;
}

void TaskRun::ended(TimePoint now) {
  const auto& action = situation_.action();
  const bool reported = dispatch_.reports(action);
  if (reported)
    for (const auto& refusal : action->refusals)
      if (status_.refusals.size() < kMaxRefusals) status_.refusals.push_back(refusal);
  const bool stopped = dispatch_.end();
  status_.phase.clear();
  effects_.on_end(now);
  const bool good = reported && action->state == ActionState::succeeded;
  if (stopped && !good) {
    progress_.drop(dispatch_.stop_reason());
    if (!replan(now))
      give_up(status_.reason.empty() ? dispatch_.stop_reason() : status_.reason, now);
    return;
  }
  if (!good) return answer_failure(action->failure, action->reason, now);
  const PlannedAction last = *progress_.current();
  effects_.expect(last);
  progress_.done();
  if (last.kind == ActionKind::give && !failures_.recovering() &&
      problem_.goal().kind == TaskKind::receive) {
    if (problem_.permit_placing(last.object))
      replan(now);
    else
      give_up(last.object + " was handed back twice: it cannot be put down as it is taken", now);
    return;
  }
  if (last.kind != ActionKind::receive || !last.object.empty()) return;
  // The received object has an id now.
  const std::string taken = !action->object.empty() ? action->object : situation_.held();
  if (taken.empty()) return;
  TaskGoal goal = problem_.goal();
  goal.object = taken;
  problem_.set_goal(goal);
  effects_.forget();
  replan(now);
}

void TaskRun::answer_failure(ActionFailure failure, const std::string& reason, TimePoint now) {
  const PlannedAction failed = *progress_.current();
  const std::string text = failed.text();
  const settings::FailureRule* rule = failures_.rule(failed.kind, failure);
  if (failures_.retry(rule, text)) {
    progress_.again(reason);
    not_before_ = now + from_seconds(rule->pause);
    status_.phase = "again: " + reason;
    return;
  }
  progress_.failed(reason);
  failures_.note(text, reason);
  problem_.forbid(failed, reason);
  if (failures_.recovering()) {
    if (!failures_.may_recover_otherwise() || !replan(now))
      finish(TaskState::failed, failures_.reason());
    return;
  }
  const bool held_anew = failed.puts_down() && problem_.has_permitted_placing(failed.object);
  const bool otherwise =
      !held_anew && (rule == nullptr || rule->then != settings::FailureRule::Answer::give_up);
  if (!otherwise || !replan(now)) give_up(failures_.first(), now);
}

void TaskRun::give_up(const std::string& reason, TimePoint now) {
  failures_.give_up(reason);
  replans_ = 0;
  if ((!dispatch_.has_begun() && situation_.held().empty()) || !replan(now))
    finish(TaskState::failed, failures_.reason());
}

void TaskRun::all_done(TimePoint now) {
  if (failures_.recovering())
    return finish(TaskState::failed, failures_.reason() + fate_of_held(progress_.plan()));
  if (const std::string out = left_out(progress_.plan()); !out.empty())
    return finish(TaskState::failed, "not all of it was done: " + out);
  const std::string unachieved = problem_.unachieved(believed(now));
  if (!unachieved.empty()) {
    if (effects_.pending(now)) return;
    if (replan(now) && progress_.current() != nullptr) return;
    if (left_out(progress_.plan()).empty()) return give_up(unachieved, now);
    return;
  }
  std::string reasons;
  for (const auto& reason : progress_.dropped()) reasons += (reasons.empty() ? "" : "; ") + reason;
  finish(TaskState::succeeded, reasons);
}

void TaskRun::pause(bool paused) {
  if (over()) return;
  status_.state = paused ? TaskState::paused : TaskState::running;
}

void TaskRun::cancel(TaskWishes& wishes) {
  if (dispatch_.state() != ActionDispatch::State::idle) dispatch_.cancel(wishes.action_goals);
  wishes.changed = true;
  finish(TaskState::cancelled, "cancelled on request");
}

void TaskRun::abort(const std::string& reason, TimePoint now, TaskWishes& wishes) {
  if (over() || failures_.recovering()) return;
  if (dispatch_.state() != ActionDispatch::State::idle) {
    dispatch_.cancel(wishes.action_goals);
    progress_.drop(reason);
  }
  dispatch_.end();
  wishes.changed = true;
  if (stage_ == Stage::searching) return finish(TaskState::failed, reason);
  give_up(reason, now);
}

bool TaskRun::give_instead(const std::string& person, TimePoint now, TaskWishes& wishes) {
  const std::string held = situation_.known() ? situation_.held() : "";
  const PlannedAction* action = progress_.current();
  if (stage_ != Stage::planned || failures_.recovering() || held.empty() ||
      !situation_.world().is(Type::human, person))
    return false;
  if (action != nullptr && action->kind == ActionKind::give) return false;
  TaskGoal goal = problem_.goal();
  goal.kind = TaskKind::give;
  goal.object = held;
  goal.human = person;
  const TaskQuery query = problem_.resolve(goal);
  if (!query.reason.empty()) return false;
  if (dispatch_.state() != ActionDispatch::State::idle) {
    dispatch_.cancel(wishes.action_goals);
    progress_.drop(person + " reaches for " + held);
  }
  dispatch_.end();
  problem_.set_goal(goal);
  problem_.set_query(query);
  wishes.changed = true;
  if (!replan(now)) give_up(status_.reason, now);
  return true;
}

}  // namespace handsel::supervisor
