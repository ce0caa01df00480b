#include "components/supervisor/task/task_run.hpp"

#include <algorithm>
#include <cmath>

#include "common/messages/names.hpp"
#include "components/supervisor/task/action_check.hpp"

namespace handsel::supervisor {
namespace {

constexpr std::size_t kMostRefusals = 64;
constexpr const char* kRunsActions = "manipulation_planner";
static_assert(static_cast<int>(ActionFailure::cancelled) == config::FailureRule::CANCELLED);

bool only_rests(const Plan& plan) {
  return std::all_of(plan.actions.begin(), plan.actions.end(), [](const PlannedAction& a) { return a.kind == ActionKind::go_to; });
}

TaskGoal normal(TaskGoal goal) {
  const bool ends_somewhere = goal.kind == TaskKind::receive || goal.kind == TaskKind::tidy;
  if (ends_somewhere && goal.onto.empty()) goal.onto = goal.surface;
  return goal;
}

}  // namespace

TaskRun::TaskRun(const config::SupervisorSettings& settings, const Domain& domain, Situation& situation, const TaskGoal& goal,
                 TimePoint now)
    : settings_(settings), domain_(domain), situation_(situation), goal_(normal(goal)), accepted_(now), text_(text_of(goal_)) {
  status_.id = goal.id;
  status_.kind = goal.kind;
  status_.state = TaskState::running;
}

const TaskStatus& TaskRun::status() {
  progress_.write(text_, status_);
  status_.phase = cut(status_.phase, kMostPhase);
  status_.reason = cut(status_.reason, kMostReason);
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
  query_ = query_for(goal_, domain_, situation_.world(), situation_.scene());
  status_.reason = query_.reason;
  const bool young = situation_.known_for(now) < settings_.sight_timeout();
  const bool person = !query_.unseen.empty() && query_.unseen == goal_.human;
  if (person && situation_.met(goal_.human)) query_.needs_person = true;
  if (!query_.reason.empty() && !query_.needs_person) return !query_.unseen.empty() && young ? Start::unsure : Start::refused;
  status_.reason.clear();
  if (query_.needs_person) {
    status_.phase = "looking for " + (goal_.human.empty() ? "somebody" : goal_.human);
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
    finish(TaskState::succeeded, already(goal_));
    return Start::begun;
  }
  take_up(std::move(plan));
  return Start::begun;
}

void TaskRun::take_up(Plan plan) {
  progress_.adopt(std::move(plan), [this](const PlannedAction& action) {
    if (const auto no = forbidden_.find(action.text()); no != forbidden_.end()) return no->second;
    const std::string fate = action.object.empty() ? "" : situation_.fate_of(action.object);
    return fate.empty() ? std::string("another way was taken") : fate;
  });
  planned_ = true;
}

State TaskRun::believed(TimePoint now) {
  State state = situation_.world().state;
  if (last_ && to_seconds(now - ended_at_) < settings_.effect_patience() && !shows(domain_, situation_.world(), *last_, state))
    apply(domain_, situation_.world(), *last_, state);
  return state;
}

Plan TaskRun::plan_from(const State& state) {
  World world = situation_.world();
  world.state = state;
  const PlanLimits limits{settings_.plan_nodes(), settings_.plan_depth()};
  if (failure_.empty()) return make_plan(domain_, world, query_.task, query_.args, forbidden_, limits);
  const std::string held = situation_.held();
  const auto home = homes_.find(held);
  const int recover = domain_.task("recover");
  if (recover < 0) return {};
  return make_plan(domain_, world, recover, {held.empty() ? "-" : held, home == homes_.end() || home->second.empty() ? "-" : home->second},
                   forbidden_, limits);
}

bool TaskRun::replan(TimePoint now) {
  if (++replans_ > settings_.most_replans()) return false;
  if (failure_.empty()) {
    const TaskQuery query = query_for(goal_, domain_, situation_.world(), situation_.scene());
    if (query.reason.empty()) query_ = query;
  }
  Plan plan = plan_from(believed(now));
  if (!plan.found) {
    status_.reason = plan.reason;
    return false;
  }
  status_.reason.clear();
  take_up(std::move(plan));
  hopeless_.reset();
  obsolete_.reset();
  return true;
}

std::string TaskRun::why_impossible(std::vector<PlannedAction> actions, State state) {
  World& world = situation_.world();
  for (const PlannedAction& action : actions) {
    if (std::string why = why_not(domain_, world, action, state); !why.empty()) return why;
    apply(domain_, world, action, state);
  }
  return "";
}

bool TaskRun::lasts(std::optional<TimePoint>& since, bool is, TimePoint now, double time) const {
  if (!is) {
    since.reset();
    return false;
  }
  if (!since) since = now;
  return to_seconds(now - *since) >= time;
}

void TaskRun::say(const std::string& phase, TaskWishes& wishes) {
  if (status_.phase == phase) return;
  status_.phase = phase;
  wishes.changed = true;
}

void TaskRun::finish(TaskState state, const std::string& reason) {
  status_.state = state;
  status_.reason = reason;
  over_ = true;
}

void TaskRun::look_for_somebody(TimePoint now, TaskWishes& wishes) {
  const TaskQuery query = query_for(goal_, domain_, situation_.world(), situation_.scene());
  if (query.reason.empty() && !query.needs_person) {
    query_ = query;
    status_.phase.clear();
    wishes.changed = true;
    if (!replan(now)) finish(TaskState::failed, status_.reason);
    return;
  }
  const bool person = query.needs_person || query.unseen == goal_.human;
  if (person && to_seconds(now - accepted_) < settings_.person_timeout()) return;
  wishes.changed = true;
  finish(TaskState::failed, query.needs_person ? "nobody is in sight to " + text_ : query.reason);
}

/// A required component that stays away ends the task, unless an action runs that may end without it.
bool TaskRun::is_stranded(TimePoint now, const std::vector<std::string>& missing) {
  const bool long_missing = lasts(missing_, !missing.empty(), now, settings_.missing_timeout());
  return long_missing && (!begun_ || std::find(missing.begin(), missing.end(), kRunsActions) != missing.end());
}

void TaskRun::step(TimePoint now, const std::vector<std::string>& missing, std::uint64_t go_epoch, std::uint64_t& next_id,
                   TaskWishes& wishes) {
  if (over_ || status_.state == TaskState::paused || !situation_.known()) return;
  if (is_stranded(now, missing)) {
    wishes.changed = true;
    const std::string patience = std::to_string(std::lround(settings_.missing_timeout())) + " s";
    return finish(TaskState::failed, missing.front() + " has not been there for " + patience);
  }
  if (!planned_) return look_for_somebody(now, wishes);
  if (begun_) {
    const auto& action = situation_.action();
    const bool heard = action && action->id == action_;
    if (heard && action->state != ActionState::running) {
      wishes.changed = true;
      ended(now);
    } else if (stopping_) {
      // A planner that was started anew knows nothing of it any more.
      if (!heard && to_seconds(now - sent_) >= settings_.goal_retry()) ended(now);
    } else {
      watch(now, wishes);
      if (over_ || stopping_) return;
      if (heard) return say(phase_text(*action), wishes);
      if (to_seconds(now - sent_) >= settings_.goal_retry()) send(now, go_epoch, next_id, wishes);
    }
    return;
  }
  if (now < not_before_ || !missing.empty()) return;
  if (progress_.current() == nullptr) {
    wishes.changed = true;
    return all_done(now);
  }
  const std::string impossible = why_impossible(progress_.left(), believed(now));
  if (!impossible.empty()) {
    wishes.changed = true;
    const bool other = hopeless_ ? false : replan(now);
    if (other) return;
    // A fact may flicker: it must be so for a while before anything is given up for it.
    if (lasts(hopeless_, true, now, settings_.settle_time())) {
      hopeless_.reset();
      if (!replan(now)) give_up(status_.reason.empty() ? impossible : status_.reason, now);
    }
    return;
  }
  hopeless_.reset();
  send(now, go_epoch, next_id, wishes);
  wishes.changed = true;
}

std::string TaskRun::held_for(const PlannedAction& action) {
  return action.object.empty() && action.kind != ActionKind::receive && action.kind != ActionKind::go_to ? situation_.held()
                                                                                                         : action.object;
}

void TaskRun::send(TimePoint now, std::uint64_t go_epoch, std::uint64_t& next_id, TaskWishes& wishes) {
  const PlannedAction& planned = *progress_.current();
  ActionGoal goal;
  goal.kind = planned.kind;
  goal.object = held_for(planned);
  goal.human = planned.human;
  goal.surface = planned.surface;
  goal.task = status_.id;
  goal.epoch = go_epoch;
  if (!begun_) {
    begun_ = true;
    broken_.reset();
    obsolete_.reset();
    status_.phase.clear();
    progress_.begin();
    if (!goal.object.empty()) {
      const std::string home = situation_.surface_of(goal.object);
      if (!home.empty()) homes_[goal.object] = home;
    }
    // After a restart of this process the action may be on its way already.
    const auto& running = situation_.action();
    const bool same = !moved_ && running && running->state == ActionState::running && running->task == status_.id &&
                      running->kind == goal.kind && goal.kind != ActionKind::place && running->object == goal.object &&
                      running->human == goal.human;
    moved_ = true;
    if (same) {
      action_ = running->id;
      return;
    }
    action_ = ++next_id;
  }
  goal.id = action_;
  wishes.action_goals.push_back(goal);
  sent_ = now;
}

void TaskRun::stop_action(TaskWishes& wishes) {
  ActionGoal stop;
  stop.id = action_;
  stop.cancel = true;
  wishes.action_goals.push_back(stop);
}

/// While an action runs: does it still make sense, and what comes after it?
void TaskRun::watch(TimePoint now, TaskWishes& wishes) {
  World& world = situation_.world();
  const PlannedAction& running = *progress_.current();
  const std::string why = broken(domain_, world, running, world.state);
  if (lasts(broken_, !why.empty(), now, settings_.settle_time())) {
    stop_action(wishes);
    sent_ = now;
    stopping_ = true;
    const std::string fate = running.object.empty() ? "" : situation_.fate_of(running.object);
    stop_reason_ = fate.empty() ? why : fate;
    return;
  }
  const std::vector<PlannedAction> later = progress_.left(true);
  if (later.empty()) return;
  State after = world.state;
  if (!shows(domain_, world, running, after)) apply(domain_, world, running, after);
  const bool obsolete = !why_impossible(later, after).empty();
  if (!lasts(obsolete_, obsolete, now, settings_.settle_time())) return;
  obsolete_.reset();
  if (replans_ >= settings_.most_replans()) return;
  Plan plan = plan_from(after);
  if (!plan.found) return;  // judged again when this action has ended
  ++replans_;
  progress_.adopt_after_running(std::move(plan), [this](const PlannedAction& action) {
    const std::string fate = action.object.empty() ? "" : situation_.fate_of(action.object);
    return fate.empty() ? std::string("another way was taken") : fate;
  });
  wishes.changed = true;
}

void TaskRun::ended(TimePoint now) {
  const auto& action = situation_.action();
  if (action && action->id == action_)
    for (const auto& refusal : action->refusals)
      if (status_.refusals.size() < kMostRefusals) status_.refusals.push_back(refusal);
  begun_ = false;
  status_.phase.clear();
  ended_at_ = now;
  const bool good = action && action->id == action_ && action->state == ActionState::succeeded;
  if (std::exchange(stopping_, false) && !good) {
    progress_.drop(stop_reason_);
    if (!replan(now)) give_up(status_.reason.empty() ? stop_reason_ : status_.reason, now);
    return;
  }
  if (!good) return answer_failure(action->failure, action->reason, now);
  last_ = *progress_.current();
  progress_.done();
  if (last_->kind != ActionKind::receive || !last_->object.empty()) return;
  // What was taken has a name now.
  const std::string taken = !action->object.empty() ? action->object : situation_.held();
  if (taken.empty()) return;
  goal_.object = taken;
  text_ = text_of(goal_);
  last_.reset();
  replan(now);
}

void TaskRun::answer_failure(ActionFailure failure, const std::string& reason, TimePoint now) {
  const PlannedAction failed = *progress_.current();
  const std::string text = failed.text();
  const auto& rules = settings_.failures();
  const auto rule = std::find_if(rules.begin(), rules.end(), [&](const config::FailureRule& r) {
    const bool of_failure = r.failure() == 0 || r.failure() == static_cast<int>(failure);
    return of_failure && (r.kind().empty() || r.kind() == name(failed.kind));
  });
  const bool ruled = rule != rules.end();
  if (ruled && rule->then() == config::FailureRule::AGAIN && tries_[text] < rule->tries()) {
    ++tries_[text];
    progress_.again(reason);
    not_before_ = now + from_seconds(rule->pause());
    status_.phase = "again: " + reason;
    return;
  }
  progress_.failed(reason);
  if (first_failure_.empty()) first_failure_ = text + ": " + reason;
  forbidden_[text] = reason;
  if (!failure_.empty()) {
    if (++failed_recoveries_ > settings_.most_recoveries() || !replan(now)) finish(TaskState::failed, failure_);
    return;
  }
  const bool otherwise = !ruled || rule->then() != config::FailureRule::GIVE_UP;
  if (!otherwise || !replan(now)) give_up(first_failure_, now);
}

void TaskRun::give_up(const std::string& reason, TimePoint now) {
  failure_ = reason;
  tries_.clear();
  replans_ = 0;
  if ((!moved_ && situation_.held().empty()) || !replan(now)) finish(TaskState::failed, failure_);
}

void TaskRun::all_done(TimePoint now) {
  if (!failure_.empty()) return finish(TaskState::failed, failure_);
  if (const std::string out = left_out(progress_.plan()); !out.empty()) return finish(TaskState::failed, "not all of it was done: " + out);
  const std::string lacking = unachieved(domain_, situation_.world(), query_.task, query_.args, believed(now));
  if (!lacking.empty()) {
    if (to_seconds(now - ended_at_) < settings_.effect_patience()) return;
    if (replan(now) && progress_.current() != nullptr) return;
    if (left_out(progress_.plan()).empty()) return give_up(lacking, now);
    return;
  }
  std::string told;
  for (const auto& reason : progress_.dropped()) told += (told.empty() ? "" : "; ") + reason;
  finish(TaskState::succeeded, told);
}

void TaskRun::pause(bool paused) {
  if (over_) return;
  status_.state = paused ? TaskState::paused : TaskState::running;
}

void TaskRun::cancel(TaskWishes& wishes) {
  if (begun_) stop_action(wishes);
  wishes.changed = true;
  finish(TaskState::cancelled, "cancelled on request");
}

void TaskRun::abort(const std::string& reason, TimePoint now, TaskWishes& wishes) {
  if (over_ || !failure_.empty()) return;
  if (begun_) {
    stop_action(wishes);
    progress_.drop(reason);
  }
  begun_ = stopping_ = false;
  wishes.changed = true;
  if (!planned_) return finish(TaskState::failed, reason);
  give_up(reason, now);
}

bool TaskRun::give_instead(const std::string& person, TimePoint now, TaskWishes& wishes) {
  const std::string held = situation_.known() ? situation_.held() : "";
  const PlannedAction* action = progress_.current();
  if (over_ || !failure_.empty() || !planned_ || held.empty() || !situation_.world().is(Type::human, person)) return false;
  if (action != nullptr && action->kind == ActionKind::give) return false;
  TaskGoal goal = goal_;
  goal.kind = TaskKind::give;
  goal.object = held;
  goal.human = person;
  const TaskQuery query = query_for(goal, domain_, situation_.world(), situation_.scene());
  if (!query.reason.empty()) return false;
  if (begun_) {
    stop_action(wishes);
    progress_.drop(person + " reaches for " + held);
  }
  begun_ = stopping_ = false;
  goal_ = goal;
  query_ = query;
  text_ = text_of(goal_);
  wishes.changed = true;
  if (!replan(now)) give_up(status_.reason, now);
  return true;
}

}  // namespace handsel::supervisor
