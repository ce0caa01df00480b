// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/story/story_runner.hpp"

#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "common/base/errors.hpp"
#include "common/messages/names.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/status.hpp"

namespace handsel {
namespace {

/// Thrown if the condition of a line of the story does not become true.
struct Unfulfilled {
  std::string why;
};

std::string seconds(Duration duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", to_seconds(duration));
  return text;
}

bool does_something(StepKind kind) {
  return kind != StepKind::wait && kind != StepKind::expect && kind != StepKind::never &&
         kind != StepKind::listen;
}

/// Returns whether a condition also held before the disturbance: it must hold when its line is
/// reached; a moment before that is not sufficient.
bool is_calm(const Condition& condition) {
  return condition.kind == ConditionKind::rest || condition.kind == ConditionKind::ready ||
         (condition.kind == ConditionKind::mode && condition.subject == name(Mode::normal));
}

/// Returns whether the hand of a group of joints has grasped something. Throws ConfigError if the
/// robot has no such hand.
bool has_grasped(const ExecutionStatus& execution, const std::string& group) {
  if (group == "hand") return execution.hand == HandState::grasped;
  std::string known = "hand";
  for (const OtherHandState& other : execution.other_hands) {
    if (other.group == group) return other.hand == HandState::grasped;
    known += ", " + other.group;
  }
  throw ConfigError("\"" + group + "\" is no hand of this robot; there are " + known);
}

std::string where(const Story& story, const StoryStep& step) {
  return story.name + ":" + std::to_string(step.line) + ": ";
}

}  // namespace

StoryRunner::StoryRunner(Story story, const StoryOptions& options)
    : story_(std::move(story)), options_(options) {}
StoryRunner::~StoryRunner() = default;

TimePoint StoryRunner::now() const { return monotonic_now(); }

bool StoryRunner::run() {
  story_begin_ = origin_ = now();
  for (std::size_t i = 0; i < story_.steps.size(); ++i) {
    const StoryStep& step = story_.steps[i];
    try {
      perform(i);
    } catch (const Unfulfilled& unfulfilled) {
      std::fprintf(stderr, "FAILED      %s%s\n            %s\n", where(story_, step).c_str(),
                   step.text.c_str(), unfulfilled.why.c_str());
      print_timeline();
      return false;
    }
    if (interrupted()) throw ConfigError("interrupted");
  }
  return true;
}

void StoryRunner::perform(std::size_t index) {
  const StoryStep& step = story_.steps[index];
  if (step.at) listen_until(task_time_ + *step.at);
  if (step.kind != StepKind::start && !system_)
    throw ConfigError(where(story_, step) + "nothing runs any more");
  if (does_something(step.kind)) {
    origin_ = now();
    begin_watching(index);
    if (system_) system_->session().observer().note(origin_, "> " + step.text);
  }
  switch (step.kind) {
    case StepKind::start:
      start(step);
      break;
    case StepKind::task:
      send_task(step);
      break;
    case StepKind::control:
      send_control(step);
      break;
    case StepKind::sim:
      send_sim(step);
      break;
    case StepKind::kill:
      for (std::size_t i = 1; i < step.words.size(); ++i) {
        const auto health = system_->session().snapshot().health.find(step.words[i]);
        if (health != system_->session().snapshot().health.end())
          killed_[step.words[i]] = health->second.sample.incarnation;
        signal_process(step.words[i], step.words[0] == "-15" ? SIGTERM : SIGKILL);
      }
      break;
    case StepKind::silence:
      signal_process(step.words[0], SIGSTOP);
      if (step.limit > Duration::zero()) to_wake_.emplace(origin_ + step.limit, step.words[0]);
      break;
    case StepKind::wake:
      signal_process(step.words[0], SIGCONT);
      break;
    case StepKind::wait:
    case StepKind::expect:
      return await(step);
    case StepKind::never:
      return refute(step);
    case StepKind::listen:
      listen_until(now() + step.limit);
      break;
    case StepKind::stop:
      stop();
      break;
  }
  std::fprintf(stderr, "%8.3f s  %s\n", to_seconds(now() - story_begin_), step.text.c_str());
}

void StoryRunner::start(const StoryStep& step) {
  SystemOptions options{.domain = options_.domain, .scenario = step.words[0], .web_port = 0};
  for (std::size_t i = 1; i < step.words.size(); i += 2) {
    if (i + 1 == step.words.size())
      throw ConfigError(where(story_, step) + "\"" + step.words[i] + "\" needs a value");
    if (step.words[i] == "seed") {
      options.seed = std::strtoull(step.words[i + 1].c_str(), nullptr, 10);
    } else if (step.words[i] == "robot") {
      options.robot = step.words[i + 1];
    } else {
      throw ConfigError(where(story_, step) + "\"" + step.words[i] +
                        "\" is neither seed nor robot");
    }
  }
  if (options_.seed) options.seed = options_.seed;
  seed_ = options.seed;
  system_ = std::make_unique<System>(options);
  sim_ = system_->session().bus().advertise<SimControl>();
  system_->session().observer().on_sample(
      [this](const Snapshot& snapshot, TimePoint at) { on_snapshot(snapshot, at); });
}

void StoryRunner::send_task(const StoryStep& step) {
  config::TaskDescription task;
  task.set_kind(step.words[0] == "goto" ? "go_to" : step.words[0]);
  std::size_t i = 1;
  const bool of_a_place = task.kind() == "go_to" || task.kind() == "clear";
  if (i < step.words.size())
    (of_a_place ? task.set_surface(step.words[i]) : task.set_object(step.words[i])), ++i;
  for (; i + 1 < step.words.size(); i += 2) {
    if (step.words[i] == "to" || step.words[i] == "from") task.set_human(step.words[i + 1]);
    if (step.words[i] == "on") task.set_surface(step.words[i + 1]);
  }
  task_id_ = system_->session().new_task_id();
  goal_ = make_goal(task, task_id_);
  if (!system_->session().send(goal_)) throw Unfulfilled{"the supervisor does not listen"};
  task_time_ = origin_ = goal_sent_ = now();
}

/// Sends the task again to a restarted supervisor.
void StoryRunner::remind() {
  const Snapshot& snapshot = system_->session().snapshot();
  const auto task = snapshot.tasks.find(task_id_);
  if (task_id_ == 0 || task == snapshot.tasks.end() || is_over(task->second.state)) return;
  if (now() - snapshot.task.arrival < kTaskSilence || now() - goal_sent_ < kTaskSilence) return;
  system_->session().publish(goal_);
  goal_sent_ = now();
}

void StoryRunner::send_control(const StoryStep& step) {
  static const std::map<std::string, TaskKind> kinds{{"pause", TaskKind::pause},
                                                     {"resume", TaskKind::resume},
                                                     {"cancel", TaskKind::cancel},
                                                     {"acknowledge", TaskKind::acknowledge},
                                                     {"speed", TaskKind::speed}};
  TaskGoal goal{.id = system_->session().new_task_id(), .kind = kinds.at(step.words[0])};
  if (step.words.size() > 1) goal.value = std::atof(step.words[1].c_str()) / 100.0;
  if (!system_->session().send(goal)) throw Unfulfilled{"the supervisor does not listen"};
  if (goal.kind == TaskKind::cancel) return;  // the cancelled task itself is the answer
  // A request of a person counts from its acknowledgement on: only then it survives the end of the
  // supervisor.
  const auto& tasks = system_->session().snapshot().tasks;
  const auto answered = [&] {
    wake_due();
    remind();
    const auto own = tasks.find(goal.id);
    return own != tasks.end() && is_over(own->second.state);
  };
  if (!system_->wait(kAnswerTimeout, answered)) throw Unfulfilled{"the supervisor does not answer"};
}

void StoryRunner::send_sim(const StoryStep& step) {
  const auto action =
      std::find(std::begin(kSimActionNames), std::end(kSimActionNames), step.words[0]);
  if (action == std::end(kSimActionNames))
    throw ConfigError(where(story_, step) + "\"" + step.words[0] +
                      "\" is no action of the simulator");
  SimControl control{.action = static_cast<SimAction>(action - std::begin(kSimActionNames))};
  for (std::size_t i = 1; i < step.words.size(); ++i) {
    char* end = nullptr;
    const double value = std::strtod(step.words[i].c_str(), &end);
    if (*end == '\0') {
      control.value = value;
    } else {
      control.subject = step.words[i];
    }
  }
  system_->session().wait(from_seconds(1.0), [&] { return sim_->readers() > 0; });
  if (!sim_->publish(control)) throw Unfulfilled{"the simulator does not listen"};
}

void StoryRunner::signal_process(const std::string& process, int signal) {
  const pid_t pid = system_->launcher().pid(process);
  if (pid <= 0)
    throw ConfigError("the story names the process \"" + process + "\", which does not run");
  if (signal == SIGCONT)
    std::erase_if(to_wake_, [&](const auto& entry) { return entry.second == process; });
  ::kill(pid, signal);
}

std::string StoryRunner::evidence(const Condition& condition) const {
  const GroundTruth& ground_truth = system_->session().snapshot().ground_truth.sample;
  switch (condition.kind) {
    case ConditionKind::no_limit_violations:
      return ": " + std::to_string(ground_truth.limit_violations) + " set-points broke a limit";
    case ConditionKind::no_ssm_violations:
      return ": for " + std::to_string(ground_truth.ssm_violations) +
             " ms the robot came nearer faster than the distance allowed, least distance " +
             std::to_string(ground_truth.min_separation) + " m";
    default:
      return {};
  }
}

void StoryRunner::await(const StoryStep& step) {
  const auto watch = std::find_if(watches_.begin(), watches_.end(),
                                  [&](const Watch& w) { return w.step == &step; });
  const TimePoint begin = step.kind == StepKind::wait ? now() : origin_;
  const TimePoint deadline = begin + step.limit;
  if (step.limit == Duration::zero()) {
    if (!holds(*step.condition, system_->session().snapshot(), now()))
      throw Unfulfilled{"it does not hold" + evidence(*step.condition)};
    watch->first = now();
  } else {
    if (step.kind == StepKind::wait) watch->held = false;
    system_->wait(std::max(deadline - now(), Duration::zero()) + from_seconds(0.05), [&] {
      on_snapshot(system_->session().snapshot(), now());
      wake_due();
      remind();
      return watch->held || now() > deadline + from_seconds(0.03);
    });
    if (!watch->held) throw Unfulfilled{"it did not hold within " + seconds(step.limit)};
    if (watch->first > deadline)
      throw Unfulfilled{"it took " + seconds(watch->first - begin) + " instead of " +
                        seconds(step.limit)};
  }
  std::fprintf(stderr, "%8.3f s  %s (after %s)\n", to_seconds(now() - story_begin_),
               step.text.c_str(), seconds(watch->first - origin_).c_str());
}

void StoryRunner::refute(const StoryStep& step) {
  const auto watch = std::find_if(watches_.begin(), watches_.end(),
                                  [&](const Watch& w) { return w.step == &step; });
  const TimePoint deadline = origin_ + step.limit;
  system_->wait(std::max(deadline - now(), Duration::zero()), [&] {
    on_snapshot(system_->session().snapshot(), now());
    wake_due();
    remind();
    return watch->held || now() > deadline;
  });
  if (watch->held && watch->first <= deadline)
    throw Unfulfilled{"it happened after " + seconds(watch->first - origin_)};
  std::fprintf(stderr, "%8.3f s  %s\n", to_seconds(now() - story_begin_), step.text.c_str());
}

void StoryRunner::stop() {
  std::vector<pid_t> pids;
  for (const ProcessStatus& process : system_->launcher().processes()) pids.push_back(process.pid);
  const TimePoint begin = now();
  sim_.reset();
  system_.reset();
  if (now() - begin > from_seconds(2.0))
    throw Unfulfilled{"stopping took " + seconds(now() - begin)};
  for (const pid_t pid : pids) {
    if (pid > 0 && ::kill(pid, 0) == 0)
      throw Unfulfilled{"process " + std::to_string(pid) + " is still there"};
  }
}

void StoryRunner::begin_watching(std::size_t index) {
  watches_.clear();
  for (std::size_t i = index + 1; i < story_.steps.size() && !does_something(story_.steps[i].kind);
       ++i) {
    if (story_.steps[i].condition) watches_.push_back({.step = &story_.steps[i]});
  }
}

void StoryRunner::on_snapshot(const Snapshot& snapshot, TimePoint at) {
  for (Watch& watch : watches_) {
    if (watch.held && !is_calm(*watch.step->condition)) continue;
    const bool held = watch.held;
    watch.held = holds(*watch.step->condition, snapshot, at);
    if (watch.held && !held) watch.first = at;
  }
}

bool StoryRunner::task_is(const std::string& word, const Snapshot& snapshot) const {
  const auto task = snapshot.tasks.find(task_id_);
  return task != snapshot.tasks.end() &&
         (word == "done" ? "succeeded" : word) == name(task->second.state);
}

bool StoryRunner::holds(const Condition& condition, const Snapshot& snapshot, TimePoint at) const {
  const std::string& subject = condition.subject;
  const auto fresh = [&](const auto& seen) { return seen.ever && seen.arrival >= origin_; };
  const GroundTruth& ground_truth = snapshot.ground_truth.sample;
  const ExecutionStatus& execution = snapshot.execution.sample;
  switch (condition.kind) {
    case ConditionKind::ready:
      return not_ready(snapshot).empty();
    case ConditionKind::mode:
      if (!fresh(snapshot.execution)) return false;
      if (subject == name(Mode::normal)) return execution.mode == Mode::normal;
      for (const Mode mode : {Mode::slow, Mode::hold, Mode::stop, Mode::fault}) {
        if (subject == name(mode)) return execution.mode >= mode;
      }
      throw ConfigError("\"" + subject +
                        "\" is no mode; there are normal, slow, hold, stop and fault");
    case ConditionKind::cause:
      return fresh(snapshot.execution) &&
             (", " + cause_names(execution.causes) + ", ").find(", " + subject + ", ") !=
                 std::string::npos;
    case ConditionKind::phase:
      return fresh(snapshot.action) && phase_text(snapshot.action.sample) == subject;
    case ConditionKind::carrier:
      return fresh(snapshot.ground_truth) && ground_truth.carrier == subject;
    case ConditionKind::hand:
      return fresh(snapshot.execution) && has_grasped(execution, subject);
    case ConditionKind::task:
      return task_is(subject, snapshot);
    case ConditionKind::handover:
      return snapshot.ground_truth.ever && ground_truth.handover_done;
    case ConditionKind::moving:
      return fresh(snapshot.ground_truth) && ground_truth.robot_moving;
    case ConditionKind::rest:
      return fresh(snapshot.ground_truth) && !ground_truth.robot_moving;
    case ConditionKind::back: {
      const auto health = snapshot.health.find(subject);
      if (health == snapshot.health.end() || !fresh(health->second) ||
          health->second.sample.state != HealthState::ok)
        return false;
      const auto killed = killed_.find(subject);
      return killed == killed_.end() || killed->second != health->second.sample.incarnation;
    }
    case ConditionKind::degraded: {
      const auto health = snapshot.health.find(subject);
      return health != snapshot.health.end() && fresh(health->second) &&
             health->second.sample.state == HealthState::degraded;
    }
    case ConditionKind::status_names: {
      const SystemStatus status = make_status(snapshot, at);
      return std::any_of(status.troubles.begin(), status.troubles.end(), [&](const std::string& t) {
        return t.find(subject) != std::string::npos;
      });
    }
    case ConditionKind::speed_below:
      return fresh(snapshot.active) &&
             std::abs(snapshot.active.sample.speed_factor) < condition.value;
    case ConditionKind::no_limit_violations:
      return snapshot.ground_truth.ever && ground_truth.limit_violations == 0;
    case ConditionKind::no_ssm_violations:
      return snapshot.ground_truth.ever && ground_truth.ssm_violations == 0;
    case ConditionKind::no_collisions:
      return snapshot.ground_truth.ever && ground_truth.self_or_scene_collisions == 0;
    case ConditionKind::one_commander:
      return snapshot.ground_truth.ever && ground_truth.commanders == 1;
    case ConditionKind::not_dropped:
      return snapshot.ground_truth.ever && !ground_truth.dropped;
  }
  return false;
}

void StoryRunner::wake_due() {
  for (auto due = to_wake_.begin(); due != to_wake_.end() && due->first <= now();
       due = to_wake_.erase(due)) {
    ::kill(system_->launcher().pid(due->second), SIGCONT);
  }
}

void StoryRunner::listen_until(TimePoint until) {
  if (!system_) return;
  system_->wait(std::max(until - now(), Duration::zero()), [this] {
    wake_due();
    remind();
    return false;
  });
}

void StoryRunner::print_timeline() const {
  std::fprintf(stderr, "timeline of %s (seed %llu, domain %d):\n", story_.name.c_str(),
               static_cast<unsigned long long>(seed_), options_.domain);
  if (!system_) return;
  for (const TimelineEvent& event : system_->session().observer().timeline()) {
    std::fprintf(stderr, "%8.3f s  %s\n", to_seconds(event.at - story_begin_), event.text.c_str());
  }
  std::fprintf(stderr, "logs are in %s\n", system_->log_directory().c_str());
}

}  // namespace handsel
