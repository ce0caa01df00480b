#include <algorithm>
#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/messages/world.hpp"
#include "deploy/handsel/commands.hpp"
#include "deploy/handsel/performer.hpp"
#include "deploy/handsel/session.hpp"
#include "deploy/handsel/system_options.hpp"
#include "deploy/handsel/terminal.hpp"

namespace handsel {
namespace {

constexpr Duration kAnswerPatience = std::chrono::seconds(3);

struct TaskOptions {
  int domain{0};
  bool json{false};
  TaskGoal goal;
};

/// Follows the goal to its end; Ctrl-C cancels it.
int perform(const TaskOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  TaskGoal goal = options.goal;
  goal.id = session.new_task_id();
  session.observer().on_event([](const TimelineEvent& event) { std::fprintf(stderr, "%s\n", event.text.c_str()); });
  if (!session.send(goal))
    throw MissingError("nobody on DDS domain " + std::to_string(options.domain) + " takes tasks: the supervisor is not there");
  const auto status = [&]() -> const TaskStatus* {
    const auto found = session.snapshot().tasks.find(goal.id);
    return found == session.snapshot().tasks.end() ? nullptr : &found->second;
  };
  const auto over = [&] { return status() && is_over(status()->state); };
  if (!session.wait(kAnswerPatience, [&] { return status() != nullptr; }) && !interrupted()) {
    throw MissingError("the supervisor did not answer the task within " + std::to_string(static_cast<int>(to_seconds(kAnswerPatience))) +
                       " s");
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
    std::printf("%s\n", nlohmann::json{{"task", describe(goal)}, {"state", state}, {"reason", reason}}.dump().c_str());
  } else {
    std::printf("%s: %s%s%s\n", describe(goal).c_str(), state.c_str(), reason.empty() ? "" : ": ", reason.c_str());
  }
  return status() && status()->state == TaskState::succeeded ? 0 : 1;
}

/// A word about the running task or the system: pause, resume, cancel, acknowledge, speed.
int tell(const TaskOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  TaskGoal goal = options.goal;
  goal.id = session.new_task_id();
  session.listen(from_seconds(0.3));  // the newest status of the running task is transient local
  const Seen<TaskStatus> before = session.snapshot().task;
  const bool about_task = goal.kind == TaskKind::pause || goal.kind == TaskKind::resume || goal.kind == TaskKind::cancel;
  if (about_task && (!before.ever || is_over(before.sample.state))) {
    std::printf("no task is running\n");
    return 1;
  }
  if (!session.send(goal))
    throw MissingError("nobody on DDS domain " + std::to_string(options.domain) + " takes tasks: the supervisor is not there");
  const auto answered = [&] {
    if (const auto own = session.snapshot().tasks.find(goal.id); own != session.snapshot().tasks.end() && is_over(own->second.state))
      return true;
    const TaskState state = session.snapshot().task.sample.state;
    return (goal.kind == TaskKind::pause && state == TaskState::paused) || (goal.kind == TaskKind::cancel && is_over(state)) ||
           (goal.kind == TaskKind::resume && (state == TaskState::running || state == TaskState::accepted));
  };
  const bool done = session.wait(about_task ? Duration(std::chrono::seconds(10)) : Duration(std::chrono::seconds(1)), answered);
  const auto own = session.snapshot().tasks.find(goal.id);
  if (own != session.snapshot().tasks.end() && own->second.state == TaskState::refused) {
    std::printf("refused: %s\n", own->second.reason.c_str());
    return 1;
  }
  if (about_task && !done) {
    std::printf("%s: not answered\n", name(goal.kind));
    return 1;
  }
  return 0;
}

/// Says who was cleared, or why nobody was.
int clear_person(const TaskOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  Seen<HumanState> people;
  session.bus().subscribe<HumanState>([&](const HumanState& sample, const Receipt& receipt) { people = {true, sample, receipt.arrival}; });
  if (!session.wait(std::chrono::seconds(1), [&] { return people.ever; }))
    throw MissingError("no HumanState on DDS domain " + std::to_string(options.domain) + ": SPARK is not there");
  const auto lost = [&] {
    std::vector<std::string> out;
    for (const Person& person : people.sample.people)
      if (person.inflation > 0 && person.hands.empty() && (options.goal.human.empty() || person.id == options.goal.human))
        out.push_back(person.id);
    return out;
  };
  const std::vector<std::string> before = lost();
  if (before.empty()) {
    const bool known = std::any_of(people.sample.people.begin(), people.sample.people.end(),
                                   [&](const Person& person) { return person.id == options.goal.human; });
    std::printf("%s\n", options.goal.human.empty() ? "nobody is lost"
                        : known                    ? (options.goal.human + " is seen, and stays").c_str()
                                                   : ("nobody is called " + options.goal.human).c_str());
    return 1;
  }
  TaskGoal goal = options.goal;
  goal.id = session.new_task_id();
  if (!session.send(goal)) throw MissingError("nobody on DDS domain " + std::to_string(options.domain) + " takes tasks");
  const bool done = session.wait(std::chrono::seconds(2), [&] { return lost().empty(); });
  for (const std::string& id : before) std::printf("%s: %s\n", id.c_str(), done ? "cleared" : "still held as lost");
  return done ? 0 : 1;
}

std::shared_ptr<TaskOptions> add(CLI::App& parent, int& exit_code, const char* word, const char* help, TaskKind kind,
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
  CLI::App* task = app.add_subcommand("task", "sends a goal to a running system and follows it to the end; Ctrl-C cancels it");
  task->require_subcommand(1);
  const auto goal = [&](const char* word, const char* help, TaskKind kind) {
    auto options = add(*task, exit_code, word, help, kind, perform);
    return std::pair(task->get_subcommand(word), options);
  };
  const auto object = [](auto& entry) { entry.first->add_option("object", entry.second->goal.object, "object")->required(); };
  const auto surface = [](auto& entry) { entry.first->add_option("surface", entry.second->goal.surface, "surface")->required(); };
  auto give = goal("give", "hands an object to a person", TaskKind::give);
  object(give);
  give.first->add_option("--to", give.second->goal.human, "person (default: the nearest attentive one)");
  auto receive = goal("receive", "takes an object from a person", TaskKind::receive);
  object(receive);
  receive.first->add_option("--from", receive.second->goal.human, "person (default: the nearest attentive one)");
  auto pick = goal("pick", "picks an object up", TaskKind::pick);
  object(pick);
  auto place = goal("place", "puts an object on a surface", TaskKind::place);
  object(place);
  surface(place);
  auto clear = goal("clear", "clears a surface", TaskKind::clear);
  surface(clear);
  auto tidy = goal("tidy", "puts an object where it belongs", TaskKind::tidy);
  object(tidy);
  surface(tidy);
  auto regrasp = goal("regrasp", "takes another grasp of an object", TaskKind::regrasp);
  object(regrasp);
  auto lift = goal("lift", "lifts an object", TaskKind::lift);
  object(lift);
  auto go_to = goal("goto", "moves the arm to a named posture", TaskKind::go_to);
  go_to.first->add_option("place", go_to.second->goal.surface, "posture")->required();
  add(*task, exit_code, "pause", "stops softly and waits", TaskKind::pause, tell);
  add(*task, exit_code, "resume", "goes on after pause", TaskKind::resume, tell);
  add(*task, exit_code, "cancel", "ends the running task", TaskKind::cancel, tell);
  add(*task, exit_code, "acknowledge", "a person has dealt with the cause of a fault", TaskKind::acknowledge, tell);

  auto clear_lost =
      add(*task, exit_code, "clear-person", "says that a person SPARK has lost sight of is gone", TaskKind::clear_person, clear_person);
  task->get_subcommand("clear-person")->add_option("person", clear_lost->goal.human, "who; without, everybody lost");

  auto speed = add(app, exit_code, "speed", "global speed override, 0-100 %", TaskKind::speed, tell);
  CLI::App* command = app.get_subcommand("speed");
  command
      ->add_option_function<double>(
          "percent", [speed](double percent) { speed->goal.value = percent / 100.0; }, "[%]")
      ->required()
      ->check(CLI::Range(0.0, 100.0));
}

}  // namespace handsel
