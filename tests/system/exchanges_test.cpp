// SPDX-License-Identifier: Apache-2.0
// Handovers in both directions with varied people, over real processes in real time. If a process
// dies, the task is completed or given up in order. HANDSEL_RUNS: trials of each;
// HANDSEL_FIRST_SEED: of the first trial.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include <nlohmann/json.hpp>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"
#include "deploy/handsel/eval/report.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel::exchanges_test {
namespace {

using Json = nlohmann::json;

constexpr double kSuccess = 0.94;
constexpr double kGiving = 15.0, kReceiving = 27.0;  // approximate min duration of such a task [s]
constexpr int kDomain = 209;
const Duration kTaskTimeout = std::chrono::minutes(4);
const Duration kRestTimeout = std::chrono::seconds(10);

std::uint64_t number(const char* variable, std::uint64_t otherwise) {
  const char* value = std::getenv(variable);
  return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
}

/// The process that dies, and the time after the goal [s].
struct Death {
  std::string process;
  double at{};
};

struct Performance {
  Json report;
  bool over{}, at_rest{};
  std::string killed_in;  ///< phase of the action
};

Performance perform(const std::string& name, std::uint64_t seed,
                    const std::optional<Death>& death) {
  config::Scenario scenario;
  load_text_proto(scenario_file(name), scenario);
  System system({.domain = kDomain, .scenario = name, .seed = seed, .web_port = 0});
  Session& session = system.session();
  Performer performer(session.bus(), session.observer(), scenario, 0,
                      [&] { return not_ready(session.snapshot()).empty(); });
  Performance out;
  const auto ready = system.wait_ready(kReadyTimeout);
  if (!ready) return out;
  ReportInputs inputs{.scenario = name,
                      .robot = robot_of(system.options()),
                      .seed = seed,
                      .ready = to_seconds(*ready)};
  inputs.before = counters(session.snapshot());
  inputs.ground_truth_before = session.snapshot().ground_truth.sample;
  if (death) {
    system.wait(kTaskTimeout, [&] {
      return performer.finished() ||
             (performer.started() &&
              session.bus().now() - performer.begin() > from_seconds(death->at));
    });
    out.killed_in = phase_text(session.snapshot().action.sample);
    if (const pid_t pid = system.launcher().pid(death->process); pid > 0) ::kill(pid, SIGKILL);
  }
  out.over = system.wait(kTaskTimeout, [&] { return performer.finished(); });
  out.at_rest = system.wait(kRestTimeout, [&] {
    return !session.snapshot().ground_truth.sample.robot_moving &&
           session.snapshot().action.sample.state != ActionState::running;
  });
  out.report = make_report(inputs, performer, session.observer());
  return out;
}

std::string told(const Json& report) {
  const Json& task = report["tasks"].back();
  return (report["success"].get<bool>() ? "done"
                                        : "failed: " + report["failure"].get<std::string>()) +
         " in " + std::to_string(task["duration_s"].get<double>()) + " s";
}

void print_timeline(const Json& report) {
  for (const Json& event : report["timeline"])
    std::printf("%9.3f s  %s\n", event["t_s"].get<double>(),
                event["event"].get<std::string>().c_str());
}

void expect_harmless(const Json& report, const std::string& what) {
  EXPECT_EQ(report["ssm_violations"], 0) << what;
  EXPECT_EQ(report["oracle"]["limit_violations"], 0) << what;
  EXPECT_FALSE(report["oracle"]["dropped"].get<bool>()) << what;
  EXPECT_LE(report["oracle"]["commanders"].get<int>(), 2)
      << what << ": more than the controller and the one that took its place";
}

class Exchanges : public testing::TestWithParam<const char*> {};

TEST_P(Exchanges, succeed_in_each_scenario) {
  const std::uint64_t runs = number("HANDSEL_RUNS", 50), first = number("HANDSEL_FIRST_SEED", 9001);
  std::uint64_t done = 0;
  std::vector<double> first_motions;
  for (std::uint64_t seed = first; seed < first + runs; ++seed) {
    const Performance trial = perform(GetParam(), seed, std::nullopt);
    ASSERT_TRUE(trial.over) << "seed " << seed;
    const std::string what =
        std::string(GetParam()) + " seed " + std::to_string(seed) + ": " + told(trial.report);
    std::printf("%s\n", what.c_str());
    std::fflush(stdout);
    done += trial.report["success"].get<bool>();
    if (const Json& moved = trial.report["tasks"][0]["first_motion_s"]; moved.is_number())
      first_motions.push_back(moved);
    expect_harmless(trial.report, what);
    EXPECT_TRUE(trial.report["success"].get<bool>() ||
                !trial.report["failure"].get<std::string>().empty())
        << what;
  }
  std::printf("%s: %llu of %llu\n", GetParam(), static_cast<unsigned long long>(done),
              static_cast<unsigned long long>(runs));
  std::sort(first_motions.begin(), first_motions.end());
  if (!first_motions.empty())
    std::printf("first motion after the goal: median %.2f s\n",
                first_motions[first_motions.size() / 2]);
  EXPECT_GE(static_cast<double>(done), kSuccess * static_cast<double>(runs));
}

INSTANTIATE_TEST_SUITE_P(OverDds, Exchanges, testing::Values("trial_give_mug", "trial_receive_mug"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(AnyDeath, ends_in_a_finished_task_or_one_given_up_in_order) {
  const std::uint64_t runs = number("HANDSEL_RUNS", 50), first = number("HANDSEL_FIRST_SEED", 7001);
  std::vector<std::string> mortal;
  for (const std::string process : kProcesses)
    if (process != "sim") mortal.push_back(process);  // the simulator is the environment
  std::uint64_t done = 0;
  for (std::uint64_t seed = first; seed < first + runs; ++seed) {
    std::mt19937_64 random(seed);
    const bool gives = seed % 2 == 0;
    const char* scenario = gives ? "give_mug" : "receive_mug";
    const Death death{
        mortal[random() % mortal.size()],
        std::uniform_real_distribution<double>(0, gives ? kGiving : kReceiving)(random)};
    const Performance trial = perform(scenario, seed, death);
    std::string what = std::string(scenario) + " seed " + std::to_string(seed) + ": " +
                       death.process + " dies after " + std::to_string(death.at) + " s in \"" +
                       trial.killed_in + "\"";
    EXPECT_TRUE(trial.over) << what;
    if (!trial.over) continue;
    what += ": " + told(trial.report);
    std::printf("%s\n", what.c_str());
    std::fflush(stdout);
    done += trial.report["success"].get<bool>();
    expect_harmless(trial.report, what);
    EXPECT_TRUE(trial.at_rest) << what;
    if (!trial.at_rest) print_timeline(trial.report);
    const std::string state = trial.report["tasks"].back()["state"];
    EXPECT_TRUE(state == "succeeded" || state == "failed" || state == "refused")
        << what << ", left " << state;
    EXPECT_TRUE(trial.report["success"].get<bool>() ||
                !trial.report["failure"].get<std::string>().empty())
        << what;
  }
  std::printf("%llu of %llu finished, the others given up\n", static_cast<unsigned long long>(done),
              static_cast<unsigned long long>(runs));
}

}  // namespace
}  // namespace handsel::exchanges_test
