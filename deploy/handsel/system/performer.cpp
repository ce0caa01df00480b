// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/performer.hpp"

#include <array>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(20);
constexpr Duration kResend = std::chrono::seconds(1);
constexpr Duration kOracleTimeout =
    std::chrono::seconds(5);  // the oracle requires that the person carries it alone for 1 s
constexpr double kDefaultTimeout = 60.0;
constexpr std::array kKinds = {
    TaskKind::give, TaskKind::receive, TaskKind::pick, TaskKind::place, TaskKind::clear,
    TaskKind::tidy, TaskKind::regrasp, TaskKind::lift, TaskKind::go_to, TaskKind::drive};

}  // namespace

std::string describe(const TaskGoal& goal) {
  std::string text = name(goal.kind);
  if (!goal.object.empty()) text += " " + goal.object;
  if (!goal.surface.empty()) text += " " + goal.surface;
  if (!goal.human.empty())
    text += (goal.kind == TaskKind::receive ? " from " : " to ") + goal.human;
  if (!goal.onto.empty()) text += " onto " + goal.onto;
  return text;
}

TaskGoal make_goal(const config::TaskDescription& task, std::uint64_t id) {
  for (const TaskKind kind : kKinds) {
    if (task.kind() == name(kind))
      return {.id = id,
              .kind = kind,
              .object = task.object(),
              .human = task.human(),
              .surface = task.surface(),
              .place = {task.place().x(), task.place().y(), task.place().z()}};
  }
  throw ConfigError(
      "a task of the scenario has the kind \"" + task.kind() +
      "\"; it must be give, receive, pick, place, clear, tidy, regrasp, lift, go_to or drive");
}

std::vector<TaskGoal> scenario_goals(const config::Scenario& scenario) {
  if (scenario.tasks().empty())
    throw ConfigError("the scenario " + scenario.name() + " has no tasks to perform");
  std::vector<TaskGoal> goals;
  for (const config::TaskDescription& task : scenario.tasks())
    goals.push_back(make_goal(task, goals.size() + 1));
  return goals;
}

bool is_over(TaskState state) {
  return state == TaskState::succeeded || state == TaskState::failed ||
         state == TaskState::cancelled || state == TaskState::refused;
}

Performer::Performer(Bus& bus, Observer& observer, const config::Scenario& scenario, double timeout,
                     std::function<bool()> ready)
    : bus_(bus),
      observer_(observer),
      publisher_(bus.advertise<TaskGoal>()),
      ready_(std::move(ready)) {
  goals_ = scenario_goals(scenario);
  continue_after_failure_ = scenario.continue_after_failure();
  timeout_ = from_seconds(timeout > 0              ? timeout
                          : scenario.timeout() > 0 ? scenario.timeout()
                                                   : kDefaultTimeout);
  bus.every(kTick, [this](TimePoint now) { tick(now); });
}

bool Performer::succeeded() const {
  for (const TaskOutcome& outcome : outcomes_) {
    if (!outcome.success) return false;
  }
  return finished() && outcomes_.size() == goals_.size();
}

void Performer::tick(TimePoint now) {
  switch (phase_) {
    case Phase::waiting:
      if (!ready_()) return;
      begin_ = now;
      begin_task(now);
      break;
    case Phase::running:
      follow(now);
      break;
    case Phase::verifying:
      verify(now);
      break;
    case Phase::finished:
      return;
  }
  if (phase_ != Phase::finished && now - begin_ > timeout_) {
    outcomes_.back().timed_out = true;
    outcomes_.back().reason =
        "not done after " + std::to_string(static_cast<int>(to_seconds(timeout_))) + " s";
    end_ = now;
    outcomes_.back().duration = to_seconds(now - task_begin_);
    phase_ = Phase::finished;
  }
}

void Performer::begin_task(TimePoint now) {
  outcomes_.push_back(
      {.task = describe(goals_[current_]), .state = "sent", .started = to_seconds(now - begin_)});
  task_begin_ = now;
  last_sent_ = now;
  handovers_before_ = observer_.snapshot().ground_truth.sample.handovers;
  publisher_->publish(goals_[current_]);
  phase_ = Phase::running;
}

void Performer::note_step(const TaskStatus& status, TimePoint now) {
  std::vector<StepOutcome>& steps = outcomes_.back().steps;
  const double at = to_seconds(now - begin_);
  const std::string step =
      status.step < status.plan.size() ? status.plan[status.step] : std::string();
  if (!steps.empty()) steps.back().duration = at - steps.back().started;
  if (!step.empty() && !is_over(status.state) && (steps.empty() || steps.back().step != step))
    steps.push_back({step, at, 0.0});
}

void Performer::follow(TimePoint now) {
  const auto& tasks = observer_.snapshot().tasks;
  const auto found = tasks.find(goals_[current_].id);
  // Sends the task until a supervisor answers; a restarted one does not know the task and resumes
  // from the state of the world.
  const Seen<TaskStatus>& newest = observer_.snapshot().task;
  const bool silent = found == tasks.end() || now - newest.arrival >= kTaskSilence;
  if (silent && now - last_sent_ >= kResend) {
    publisher_->publish(goals_[current_]);
    last_sent_ = now;
  }
  if (found == tasks.end()) return;
  const TaskStatus& status = found->second;
  note_step(status, now);
  TaskOutcome& outcome = outcomes_.back();
  const Seen<GroundTruth>& ground_truth = observer_.snapshot().ground_truth;
  if (outcome.first_motion < 0 && ground_truth.arrival > task_begin_ &&
      ground_truth.sample.robot_moving)
    outcome.first_motion = to_seconds(ground_truth.arrival - task_begin_);
  const TaskKind kind = goals_[current_].kind;
  const std::string_view taker = kind == TaskKind::give      ? "human"
                                 : kind == TaskKind::receive ? "robot"
                                                             : "";
  if (outcome.handover < 0 && ground_truth.arrival > task_begin_ && !taker.empty() &&
      ground_truth.sample.carrier == taker)
    outcome.handover = to_seconds(ground_truth.arrival - task_begin_);
  outcome.state = name(status.state);
  outcome.reason = status.reason;
  outcome.refusals = status.refusals;
  outcome.duration = to_seconds(now - task_begin_);
  if (!is_over(status.state)) return;
  verify_begin_ = now;
  phase_ = Phase::verifying;
  verify(now);
}

void Performer::verify(TimePoint now) {
  const TaskGoal& goal = goals_[current_];
  TaskOutcome& outcome = outcomes_.back();
  const bool supervisor_says = outcome.state == name(TaskState::succeeded);
  if (goal.kind != TaskKind::give && goal.kind != TaskKind::receive) {
    outcome.success = supervisor_says;
    return conclude(now);
  }
  const Seen<GroundTruth>& ground_truth = observer_.snapshot().ground_truth;
  const bool changed_hands = ground_truth.ever &&
                             (goal.object.empty() || ground_truth.sample.object == goal.object) &&
                             ground_truth.sample.handovers > handovers_before_;
  const bool is_put_down = goal.kind != TaskKind::receive ||
                           (supervisor_says && ground_truth.sample.carrier == "surface");
  if (changed_hands && is_put_down) {
    outcome.success = true;
    return conclude(now);
  }
  if (supervisor_says && now - verify_begin_ < kOracleTimeout) return;
  if (supervisor_says) {
    outcome.reason =
        !ground_truth.ever            ? "no word from the simulator's oracle"
        : ground_truth.sample.dropped ? goal.object + " was dropped"
        : ground_truth.sample.object != goal.object
            ? "the simulator's oracle watches " + ground_truth.sample.object + ", not " +
                  goal.object
        : changed_hands
            ? "the simulator's oracle saw the handover, but " + goal.object + " is on no surface"
            : "the simulator's oracle saw no handover: " + goal.object + " is with " +
                  (ground_truth.sample.carrier.empty() ? "nobody" : ground_truth.sample.carrier);
  }
  conclude(now);
}

void Performer::conclude(TimePoint now) {
  const bool continues = outcomes_.back().success || continue_after_failure_;
  if (continues && ++current_ < goals_.size()) return begin_task(now);
  end_ = now;
  phase_ = Phase::finished;
}

void Performer::abort(const std::string& reason) {
  if (finished()) return;
  end_ = bus_.now();
  if (phase_ == Phase::waiting) begin_ = end_;
  if (!outcomes_.empty()) {
    outcomes_.back().reason = reason;
    outcomes_.back().duration = to_seconds(end_ - task_begin_);
  }
  phase_ = Phase::finished;
}

}  // namespace handsel
