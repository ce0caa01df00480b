// SPDX-License-Identifier: Apache-2.0
// Processes of a running system hang or die: each is replaced and works again within 5 s, the task
// continues or ends with its reason, and the speed stays within SSM. By default three faults;
// HANDSEL_PHASES: number of random phases of SIGSTOP and kill -9 for each of HANDSEL_PROCESSES
// (comma separated; default: every process). HANDSEL_FIRST_SEED: of the random choices.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "common/messages/names.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/status.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::supervised_life_test {
namespace {

namespace fs = std::filesystem;

constexpr int kDomain = 214;
constexpr double kBack = 5.0;      // max time until the process works again [s]
constexpr double kMaxPhase = 8.0;  // max time of a fault after the goal, below a pick's [s]
const Duration kTimeout = std::chrono::seconds(90), kRestTimeout = std::chrono::seconds(10);

struct Blow {
  std::string process;
  int signal{};
  double at{};  // time after the goal [s]; negative: at the start of motion
};

struct Outcome {
  double back{-1.0};  // time from the fault to the recovery [s]
  std::string phase;  // of the action during the fault
  TaskStatus task;
  std::uint64_t ssm_violations{}, limit_violations{};  // since the fault
  bool over{}, at_rest{}, dropped{};
};

std::string describe(const Blow& blow, const Outcome& outcome) {
  char text[512];
  std::snprintf(text, sizeof text, "%-8s %-22s in \"%s\": back after %.2f s, task %s%s%s",
                blow.signal == SIGSTOP ? "SIGSTOP" : "kill -9", blow.process.c_str(),
                outcome.phase.c_str(), outcome.back, name(outcome.task.state),
                outcome.task.reason.empty() ? "" : ": ", outcome.task.reason.c_str());
  return text;
}

/// A running system in which a mug is picked up and put down again, for ever.
class Life {
 public:
  explicit Life(std::uint64_t seed)
      : system_({.domain = kDomain, .scenario = "give_mug", .seed = seed, .web_port = 0}) {
    system_.session().observer().on_event(
        [this](const TimelineEvent& event) { events_.push_back(event); });
  }
  bool ready() { return system_.wait_ready(kReadyTimeout).has_value(); }
  Outcome strike(const Blow& blow);
  /// Returns the events since the last goal.
  std::string timeline() const {
    std::ostringstream out;
    for (const TimelineEvent& event : events_)
      out << "  " << to_seconds(event.at - task_at_) << " s  " << event.text << "\n";
    return out.str();
  }
  System& system() { return system_; }

 private:
  const Snapshot& now() { return system_.session().snapshot(); }
  bool holds_mug() { return now().ground_truth.sample.carrier == "robot"; }
  void give_task();
  void remind();
  bool until(Duration limit, const std::function<bool()>& done) {
    return system_.wait(limit, [&] {
      remind();
      return done();
    });
  }
  bool task_over() {
    const auto task = now().tasks.find(goal_.id);
    return task != now().tasks.end() && is_over(task->second.state);
  }
  bool is_back(const std::string& process, pid_t old) {
    const auto health = now().health.find(process);
    return health != now().health.end() &&
           static_cast<pid_t>(health->second.sample.pid) == system_.launcher().pid(process) &&
           system_.launcher().pid(process) != old && why_not_ready(now(), process).empty();
  }

  System system_;
  TaskGoal goal_;
  TimePoint task_at_{}, sent_{};
  std::vector<TimelineEvent> events_;
};

void Life::give_task() {
  config::TaskDescription task;
  task.set_object("mug");
  task.set_kind(holds_mug() ? "place" : "pick");
  if (holds_mug()) task.set_surface("table");
  goal_ = make_goal(task, system_.session().new_task_id());
  events_.clear();
  system_.session().send(goal_);
  task_at_ = sent_ = monotonic_now();
}

/// A supervisor that was started anew is given the task again.
void Life::remind() {
  if (goal_.id == 0 || task_over() || monotonic_now() - now().task.arrival < kTaskSilence ||
      monotonic_now() - sent_ < kTaskSilence)
    return;
  system_.session().publish(goal_);
  sent_ = monotonic_now();
}

Outcome Life::strike(const Blow& blow) {
  Outcome out;
  until(kRestTimeout, [&] {
    return !now().ground_truth.sample.robot_moving && not_ready(now()).empty() &&
           now().execution.sample.mode < Mode::hold;
  });
  give_task();
  until(kTimeout, [&] {
    if (task_over()) return true;
    return blow.at < 0 ? now().ground_truth.sample.robot_moving
                       : monotonic_now() - task_at_ > from_seconds(blow.at);
  });
  const GroundTruth before = now().ground_truth.sample;
  const pid_t old = system_.launcher().pid(blow.process);
  out.phase = phase_text(now().action.sample);
  const TimePoint struck = monotonic_now();
  ::kill(old, blow.signal);
  if (until(from_seconds(3 * kBack), [&] { return is_back(blow.process, old); }))
    out.back = to_seconds(monotonic_now() - struck);
  out.over = until(kTimeout, [&] { return task_over(); });
  out.at_rest = until(kRestTimeout, [&] { return !now().ground_truth.sample.robot_moving; });
  if (const auto task = now().tasks.find(goal_.id); task != now().tasks.end())
    out.task = task->second;
  const GroundTruth& after = now().ground_truth.sample;
  const bool new_world = after.sim_time < before.sim_time;
  out.ssm_violations = after.ssm_violations - (new_world ? 0 : before.ssm_violations);
  out.limit_violations = after.limit_violations - (new_world ? 0 : before.limit_violations);
  out.dropped = after.dropped && (new_world || !before.dropped);
  return out;
}

void expect_in_order(const Blow& blow, const Outcome& outcome, const std::string& timeline) {
  const std::string what = describe(blow, outcome) + "\n" + timeline;
  EXPECT_GE(outcome.back, 0.0) << what;
  EXPECT_LE(outcome.back, kBack) << what;
  EXPECT_TRUE(outcome.over) << "the task hangs: " << what;
  EXPECT_NE(outcome.task.state, TaskState::refused) << "nothing was struck: " << what;
  EXPECT_TRUE(outcome.task.state == TaskState::succeeded || !outcome.task.reason.empty()) << what;
  EXPECT_TRUE(outcome.at_rest) << what;
  EXPECT_EQ(outcome.ssm_violations, 0u) << what;
  EXPECT_EQ(outcome.limit_violations, 0u) << what;
}

std::vector<Blow> three_blows() {
  return {{"path_planner", SIGSTOP, 0.3},
          {"spark", SIGSTOP, -1.0},
          {"trajectory_controller", SIGKILL, -1.0}};
}

std::vector<Blow> all_blows(int phases, std::mt19937_64& random) {
  std::vector<std::string> processes;
  if (const char* named = std::getenv("HANDSEL_PROCESSES")) {
    std::istringstream in(named);
    for (std::string one; std::getline(in, one, ',');) processes.push_back(one);
  } else {
    processes.assign(kProcesses.begin(), kProcesses.end());
  }
  std::vector<Blow> blows;
  for (const std::string& process : processes)
    for (int k = 0; k < phases; ++k)
      for (const int signal : {SIGSTOP, SIGKILL})
        blows.push_back(
            {process, signal, std::uniform_real_distribution<double>(0.0, kMaxPhase)(random)});
  return blows;
}

TEST(SupervisedLife, whoever_hangs_or_dies_is_replaced_and_the_task_ends_in_order) {
  const char* phases = std::getenv("HANDSEL_PHASES");
  const char* first = std::getenv("HANDSEL_FIRST_SEED");
  std::mt19937_64 random(first ? std::strtoull(first, nullptr, 10) : 6001);
  const std::vector<Blow> blows = phases ? all_blows(std::atoi(phases), random) : three_blows();
  auto life = std::make_unique<Life>(random());
  ASSERT_TRUE(life->ready());
  int done = 0, given_up = 0, late = 0;
  double slowest = 0.0;
  for (const Blow& blow : blows) {
    const Outcome outcome = life->strike(blow);
    std::printf("%s\n", describe(blow, outcome).c_str());
    std::fflush(stdout);
    expect_in_order(blow, outcome, life->timeline());
    (outcome.task.state == TaskState::succeeded ? done : given_up) += 1;
    late += outcome.back < 0.0 || outcome.back > kBack;
    slowest = std::max(slowest, outcome.back);
    if (!outcome.over || outcome.dropped ||
        outcome.back < 0.0) {  // the next fault needs a working system
      life.reset();
      life = std::make_unique<Life>(random());
      ASSERT_TRUE(life->ready());
    }
  }
  std::printf(
      "%zu blows: %d tasks done, %d given up in order; back after at most %.2f s, %d later than "
      "%.0f s\n",
      blows.size(), done, given_up, slowest, late, kBack);
}

/// The product in a folder of its own, where one program can be made to fail, with settings of its
/// own.
struct Installation {
  test::TemporaryFolder folder;
  fs::path broken = folder.path() / "broken";  // while this file exists, the planner exits at once

  Installation() {
    const fs::path bin = folder.path() / "bin", home = folder.path() / "home",
                   built = fs::path(HANDSEL_COMMAND).parent_path();
    fs::create_directories(bin);
    fs::create_directories(home / "config");
    fs::copy_file(HANDSEL_COMMAND,
                  bin / "handsel");  // a process finds the others in its own folder
    for (const auto& entry : fs::directory_iterator(built)) {
      const std::string program = entry.path().filename();
      if (program.starts_with("handsel_") && program != "handsel_path_planner")
        fs::create_symlink(entry.path(), bin / program);
    }
    std::ofstream(bin / "handsel_path_planner")
        << "#!/bin/sh\nif [ -e " << broken.string()
        << " ]; then echo 'the library is gone' >&2; exit 3; fi\nexec "
        << (built / "handsel_path_planner").string() << " \"$@\"\n";
    fs::permissions(bin / "handsel_path_planner", fs::perms::owner_all);
    const fs::path deploy = fs::path(HANDSEL_SOURCE_DIR) / "deploy";
    for (const char* part : {"robots", "hands", "objects", "dds"})
      fs::create_symlink(deploy / part, home / part);
    fs::create_symlink(deploy.parent_path() / "sim" / "scenarios", home / "scenarios");
    for (const auto& entry : fs::directory_iterator(deploy / "config"))
      fs::copy_file(entry.path(), home / "config" / entry.path().filename());
    std::string settings = text_of(home / "config" / "supervisor.txtpb");
    const std::string patience = "missing_timeout: 20.0";
    EXPECT_NE(settings.find(patience), std::string::npos);
    settings.replace(settings.find(patience), patience.size(), "missing_timeout: 3.0");
    std::ofstream(home / "config" / "supervisor.txtpb") << settings;
    setenv("HANDSEL_HOME", home.c_str(), 1);
  }
  ~Installation() { unsetenv("HANDSEL_HOME"); }
  std::string command() const { return folder.path() / "bin" / "handsel"; }
  static std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
};

TEST(SupervisedLife,
     a_planner_that_cannot_be_started_any_more_degrades_the_system_and_does_not_end_it) {
  Installation installation;
  const std::string domain = std::to_string(kDomain + 1);
  test::Background up(
      {installation.command(), "up", "--headless", "--port", "0", "--domain", domain});
  ASSERT_TRUE(up.wait_for("ready after")) << up.said();
  Session session(kDomain + 1);
  const auto line = [&] {
    const SystemStatus status = make_status(session.snapshot(), session.bus().now());
    const auto found = std::find_if(
        status.processes.begin(), status.processes.end(),
        [](const ProcessLine& process) { return process.component == "path_planner"; });
    return found == status.processes.end() ? ProcessLine{} : *found;
  };
  ASSERT_TRUE(session.wait(from_seconds(5), [&] {
    return line().state == "ok" && not_ready(session.snapshot()).empty();
  }));
  std::ofstream(installation.broken) << "x";
  ASSERT_EQ(::kill(static_cast<pid_t>(line().pid), SIGKILL), 0);
  config::TaskDescription pick;
  pick.set_kind("pick");
  pick.set_object("mug");
  const TaskGoal goal = make_goal(pick, session.new_task_id());
  EXPECT_TRUE(session.wait(from_seconds(5), [&] { return line().state == "restarting"; }))
      << line().state;
  ASSERT_TRUE(session.send(goal));
  EXPECT_TRUE(session.wait(
      from_seconds(10),
      [&] { return line().state == "restarting" && line().reason.starts_with("restart 5 in "); }))
      << line().state << ": " << line().reason;
  EXPECT_NE(line().reason.find("ended with exit code 3 (the library is gone)"), std::string::npos)
      << line().reason;

  const auto task = [&] {
    const auto found = session.snapshot().tasks.find(goal.id);
    return found == session.snapshot().tasks.end() ? TaskStatus{} : found->second;
  };
  EXPECT_TRUE(session.wait(from_seconds(10), [&] { return is_over(task().state); }))
      << "the task hangs: " << name(task().state);
  EXPECT_NE(task().reason.find("path_planner has not been there for 3 s"), std::string::npos)
      << task().reason;
  for (const auto& [component, seen] : session.snapshot().health) {
    if (component == "path_planner") continue;
    EXPECT_LT(to_seconds(session.bus().now() - seen.arrival), 1.0) << component << " went with it";
  }
  EXPECT_EQ(up.wait(0), -1) << "the system has ended: " << up.said();

  fs::remove(installation.broken);
  EXPECT_TRUE(session.wait(from_seconds(15), [&] { return not_ready(session.snapshot()).empty(); }))
      << line().state << ": " << line().reason;
  EXPECT_EQ(up.interrupt(), 0) << up.said();
}

}  // namespace
}  // namespace handsel::supervised_life_test
