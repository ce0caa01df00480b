// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/messages/world.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

/// Returns the plan as a tree, one line per task or action.
std::string tree_text(const std::vector<PlanStep>& tree) {
  constexpr std::array kMarks = {"[ ] ", "[>] ", "[x] ", "[!] ", "[-] "};
  std::string out;
  for (const PlanStep& step : tree) {
    out +=
        std::string(2 * step.depth, ' ') + kMarks[static_cast<std::size_t>(step.state)] + step.text;
    if (step.depth > 0 && !step.reason.empty()) out += " (" + step.reason + ")";
    out += "\n";
  }
  return out;
}

/// Shows the tree on stderr whenever it changes, below the events: in place on a terminal,
/// otherwise only new lines.
class TreeView {
 public:
  void show(const TaskStatus& status) {
    const std::string text = tree_text(status.tree);
    if (text == shown_) return;
    erase();
    shown_ = text;
    draw();
  }
  void report(const std::string& event) {
    if (event.starts_with("task ")) return;  // the tree contains it
    erase();
    std::fprintf(stderr, "%s\n", event.c_str());
    if (in_place_) draw();
  }

 private:
  void erase() const {
    const auto lines = std::count(shown_.begin(), shown_.end(), '\n');
    if (in_place_ && lines > 0) std::fprintf(stderr, "\033[%dA\033[J", static_cast<int>(lines));
  }
  void draw() {
    if (in_place_) {
      std::fprintf(stderr, "%s", shown_.c_str());
      return;
    }
    std::istringstream lines(shown_);
    for (std::string line; std::getline(lines, line);)
      if (reported_.insert(line).second) std::fprintf(stderr, "%s\n", line.c_str());
  }
  const bool in_place_{progress_wanted()};
  std::string shown_;
  std::set<std::string> reported_;
};

nlohmann::json tree_json(const std::vector<PlanStep>& tree) {
  nlohmann::json out = nlohmann::json::array();
  for (const PlanStep& step : tree)
    out.push_back({{"text", step.text},
                   {"depth", step.depth},
                   {"state", name(step.state)},
                   {"reason", step.reason}});
  return out;
}

struct TaskOptions {
  int domain{0};
  bool json{false};
  TaskGoal goal;
};

/// Performs the goal to its end; Ctrl-C cancels it.
int perform(const TaskOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  TaskGoal goal = options.goal;
  goal.id = session.new_task_id();
  if (!session.send(goal))
    throw MissingError("nobody on DDS domain " + std::to_string(options.domain) +
                       " takes tasks: the supervisor is not there");
  const auto status = [&]() -> const TaskStatus* {
    const auto found = session.snapshot().tasks.find(goal.id);
    return found == session.snapshot().tasks.end() ? nullptr : &found->second;
  };
  TreeView view;
  session.observer().on_event([&view](const TimelineEvent& event) { view.report(event.text); });
  TimePoint sent = session.bus().now();
  const auto over = [&] {
    if (status()) view.show(*status());
    // The goal is sent again to a restarted supervisor, which resumes from the state of the world.
    const TimePoint now = session.bus().now();
    if (status() && !is_over(status()->state) &&
        now - session.snapshot().task.arrival >= kTaskSilence && now - sent >= kTaskSilence) {
      session.publish(goal);
      sent = now;
    }
    return status() && is_over(status()->state);
  };
  if (!session.wait(kAnswerTimeout, [&] { return status() != nullptr; }) && !interrupted()) {
    throw MissingError("the supervisor did not answer the task within " +
                       std::to_string(static_cast<int>(to_seconds(kAnswerTimeout))) + " s");
  }
  if (!session.wait(std::chrono::hours(24), over) && interrupted()) {
    std::fprintf(stderr, "cancelling %s\n", describe(goal).c_str());
    session.send({.id = session.new_task_id(), .kind = TaskKind::cancel});
    session.bus().run_until(over, std::chrono::seconds(10));
  }
  session.observer().on_event({});
  const std::string state = status() ? name(status()->state) : "unanswered";
  const std::string reason = status() ? status()->reason : "";
  if (json_wanted(options.json)) {
    std::printf(
        "%s\n",
        nlohmann::json{{"task", describe(goal)},
                       {"state", state},
                       {"reason", reason},
                       {"tree", tree_json(status() ? status()->tree : std::vector<PlanStep>{})}}
            .dump()
            .c_str());
  } else {
    std::printf("%s: %s%s%s\n", describe(goal).c_str(), state.c_str(), reason.empty() ? "" : ": ",
                reason.c_str());
  }
  return status() && status()->state == TaskState::succeeded ? 0 : 1;
}

/// Sends a request about the running task, the robot or the system: pause, resume, cancel,
/// acknowledge, speed. Then prints the causes that hold the robot.
int send_request(const TaskOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  TaskGoal goal = options.goal;
  goal.id = session.new_task_id();
  session.listen(from_seconds(0.3));  // the latest status of the running task is transient local
  const Seen<TaskStatus> before = session.snapshot().task;
  const bool about_task = goal.kind == TaskKind::cancel;
  if (about_task && (!before.ever || is_over(before.sample.state))) {
    std::printf("no task is running\n");
    return 1;
  }
  if (!session.send(goal))
    throw MissingError("nobody on DDS domain " + std::to_string(options.domain) +
                       " takes tasks: the supervisor is not there");
  const auto answered = [&] {
    if (const auto own = session.snapshot().tasks.find(goal.id);
        own != session.snapshot().tasks.end() && is_over(own->second.state))
      return true;
    return goal.kind == TaskKind::cancel && is_over(session.snapshot().task.sample.state);
  };
  const bool done =
      session.wait(std::chrono::seconds(goal.kind == TaskKind::speed ? 2 : 10), answered);
  const auto own = session.snapshot().tasks.find(goal.id);
  if (own != session.snapshot().tasks.end() && own->second.state == TaskState::refused) {
    std::printf("refused: %s\n", own->second.reason.c_str());
    return 1;
  }
  if (!done) {
    std::printf("%s: not answered\n", name(goal.kind));
    return 1;
  }
  const std::string& held = session.snapshot().safety.sample.reason;
  if (goal.kind != TaskKind::pause && !held.empty()) std::printf("still held: %s\n", held.c_str());
  return 0;
}

/// Prints who was cleared, or the reason why no one was.
int clear_person(const TaskOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  Seen<HumanState> people;
  session.bus().subscribe<HumanState>([&](const HumanState& sample, const Receipt& receipt) {
    people = {true, sample, receipt.arrival};
  });
  if (!session.wait(std::chrono::seconds(1), [&] { return people.ever; }))
    throw MissingError("no HumanState on DDS domain " + std::to_string(options.domain) +
                       ": SPARK is not there");
  const auto lost = [&] {
    std::vector<std::string> out;
    for (const Person& person : people.sample.people)
      if (person.inflation > 0 && person.hands.empty() &&
          (options.goal.human.empty() || person.id == options.goal.human))
        out.push_back(person.id);
    return out;
  };
  const std::vector<std::string> before = lost();
  if (before.empty()) {
    const bool known =
        std::any_of(people.sample.people.begin(), people.sample.people.end(),
                    [&](const Person& person) { return person.id == options.goal.human; });
    std::printf("%s\n", options.goal.human.empty() ? "nobody is lost"
                        : known ? (options.goal.human + " is seen, and stays").c_str()
                                : ("nobody is called " + options.goal.human).c_str());
    return 1;
  }
  TaskGoal goal = options.goal;
  goal.id = session.new_task_id();
  if (!session.send(goal))
    throw MissingError("nobody on DDS domain " + std::to_string(options.domain) + " takes tasks");
  const bool done = session.wait(std::chrono::seconds(2), [&] { return lost().empty(); });
  for (const std::string& id : before)
    std::printf("%s: %s\n", id.c_str(), done ? "cleared" : "still held as lost");
  return done ? 0 : 1;
}

/// Adds the options of a target, one of which is required.
void add_drive_options(CLI::App& command, TaskGoal& goal) {
  CLI::Option_group* target = command.add_option_group("target", "destination");
  target->add_option("--object", goal.object, "object that the arm will reach from there");
  target->add_option("--surface", goal.surface, "surface that the arm will reach from there");
  target->add_option("--to", goal.human, "person to whom the arm can hand objects over from there");
  target
      ->add_option_function<std::vector<double>>(
          "--at",
          [&goal](const std::vector<double>& place) {
            goal.place = {place[0], place[1], place[2]};
          },
          "x y [m] and heading [rad] of the platform in the world frame")
      ->expected(3);
  target->require_option(1);
}

std::shared_ptr<TaskOptions> add(CLI::App& parent, int& exit_code, const char* word,
                                 const char* help, TaskKind kind,
                                 int (*action)(const TaskOptions&)) {
  auto options = std::make_shared<TaskOptions>();
  options->goal.kind = kind;
  CLI::App* command = parent.add_subcommand(word, help);
  add_domain_option(*command, options->domain);
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([options, action, &exit_code] { exit_code = action(*options); });
  return options;
}

}  // namespace

void add_task_commands(CLI::App& app, int& exit_code) {
  CLI::App* task = app.add_subcommand(
      "task", "sends a task to a running system and waits for its end; Ctrl-C cancels the task");
  task->require_subcommand(1);
  const auto goal = [&](const char* word, const char* help, TaskKind kind) {
    auto options = add(*task, exit_code, word, help, kind, perform);
    return std::pair(task->get_subcommand(word), options);
  };
  const auto object = [](auto& entry) {
    entry.first->add_option("object", entry.second->goal.object, "object")->required();
  };
  const auto surface = [](auto& entry) {
    entry.first->add_option("surface", entry.second->goal.surface, "surface")->required();
  };
  auto give = goal("give", "hands an object to a person", TaskKind::give);
  object(give);
  give.first->add_option("--to", give.second->goal.human,
                         "person (default: the nearest attentive one)");
  const auto onto = [](auto& entry, const char* what) {
    entry.first->add_option("--onto", entry.second->goal.onto, what);
  };
  auto receive =
      goal("receive", "takes an object from a person and puts it down", TaskKind::receive);
  receive.first->add_option("object", receive.second->goal.object,
                            "object (default: the offered one)");
  receive.first->add_option(
      "--from", receive.second->goal.human,
      "person (default: a person who offers an object, else the nearest attentive one)");
  onto(receive, "surface on which the object is put (default: any with a free place)");
  auto pick = goal("pick", "picks an object up", TaskKind::pick);
  object(pick);
  auto place = goal("place", "puts an object on a surface", TaskKind::place);
  object(place);
  surface(place);
  auto clear = goal("clear", "clears a surface", TaskKind::clear);
  surface(clear);
  onto(clear, "surface on which the objects are put (default: any with a free place)");
  auto tidy =
      goal("tidy", "puts an object, or all objects of a model, on a surface", TaskKind::tidy);
  tidy.first->add_option("object", tidy.second->goal.object, "object, or the name of a model")
      ->required();
  tidy.first->add_option("onto", tidy.second->goal.onto, "surface")->required();
  auto regrasp = goal("regrasp", "takes another grasp of an object", TaskKind::regrasp);
  object(regrasp);
  auto lift = goal("lift", "lifts an object", TaskKind::lift);
  object(lift);
  auto go_to = goal("goto", "moves the arm to a named configuration", TaskKind::go_to);
  go_to.first->add_option("place", go_to.second->goal.surface, "name of the configuration: rest")
      ->required();
  auto drive = goal("drive", "drives the platform to an object, a surface, a person or a place",
                    TaskKind::drive);
  add_drive_options(*drive.first, drive.second->goal);
  add(*task, exit_code, "pause",
      "stops the robot with limited jerk until resume, also across restarts of processes",
      TaskKind::pause, send_request);
  add(*task, exit_code, "resume", "ends a pause, and the waiting after a stop of the robot",
      TaskKind::resume, send_request);
  add(*task, exit_code, "cancel", "ends the running task", TaskKind::cancel, send_request);
  add(*task, exit_code, "acknowledge",
      "states that a person has removed the cause of a fault or stop", TaskKind::acknowledge,
      send_request);

  auto clear_lost = add(*task, exit_code, "clear-person",
                        "states that a person whom SPARK does not observe any more has left",
                        TaskKind::clear_person, clear_person);
  task->get_subcommand("clear-person")
      ->add_option("person", clear_lost->goal.human,
                   "person (default: all who are not observed any more)");

  auto speed =
      add(app, exit_code, "speed", "sets the global speed override", TaskKind::speed, send_request);
  CLI::App* command = app.get_subcommand("speed");
  command
      ->add_option_function<double>(
          "percent", [speed](double percent) { speed->goal.value = percent / 100.0; },
          "speed override [%]")
      ->required()
      ->check(CLI::Range(0.0, 100.0));
}

}  // namespace handsel
