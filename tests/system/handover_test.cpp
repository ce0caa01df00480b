// SPDX-License-Identifier: Apache-2.0
// The handover, checked by the simulator's oracle: over DDS and in lock-step, with people who take,
// people who never move, recorded people, and a robot that never releases.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/trial.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::handover_test {
namespace {

using Json = nlohmann::json;

/// Returns the number of seeds, HANDSEL_SEEDS or ten.
int seed_count() {
  const char* seeds = std::getenv("HANDSEL_SEEDS");
  return seeds != nullptr ? std::atoi(seeds) : 10;
}
/// Returns nine of ten of a number, rounded up.
int nine_of_ten(int count) { return (9 * count + 9) / 10; }

std::vector<Json> in_lockstep(const std::string& scenario, int seeds) {
  std::vector<Trial> trials;
  NodeContext context = system_context(scenario, "", 1);
  for (int seed = 1; seed <= seeds; ++seed) {
    context.seed = static_cast<std::uint64_t>(seed);
    trials.push_back({context, {.scenario = scenario}});
  }
  std::vector<Json> lines;
  EXPECT_TRUE(run_trials(trials, 2, [&](const Json& line) { lines.push_back(line); }))
      << "a trial crashed";
  return lines;
}

/// `timeout` [s]; empty: the scenario's.
Json over_dds(const std::string& scenario, int seed, const std::string& timeout = {}) {
  const test::Outcome outcome =
      test::shell(std::string(HANDSEL_COMMAND) +
                  " run --headless --port 0 --domain 207 --scenario " + scenario + " --seed " +
                  std::to_string(seed) + (timeout.empty() ? "" : " --timeout " + timeout));
  const Json report = Json::parse(outcome.out, nullptr, false);
  if (report.is_discarded()) {
    ADD_FAILURE() << "no report; exit code " << outcome.exit_code << ": " << outcome.err;
    return {{"success", false}, {"failure", "no report"}};
  }
  EXPECT_EQ(outcome.exit_code, report["success"].get<bool>() ? 0 : 1);
  return report;
}

void expect_bounded(const Json& line, const std::string& what) {
  ASSERT_TRUE(line.contains("limit_ratio")) << what << ": " << line.dump();
  for (const char* derivative : {"v", "a", "j"})
    EXPECT_LE(line["limit_ratio"][derivative].get<double>(), 1.0 + 1e-6)
        << what << " " << derivative;
  EXPECT_EQ(line["ssm_violations"], 0) << what;
}

int successes(const std::vector<Json>& lines) {
  int count = 0;
  for (const Json& line : lines) {
    if (line["success"].get<bool>()) {
      ++count;
    } else {
      std::printf("seed %s: %s %s\n", line["seed"].dump().c_str(), line["failure"].dump().c_str(),
                  line["reason"].dump().c_str());
    }
  }
  return count;
}

TEST(Handover, seeds_over_dds_succeed_and_lockstep_agrees) {
  const int seeds = seed_count(), at_least = nine_of_ten(seeds);
  ASSERT_GT(seeds, 0) << "HANDSEL_SEEDS is no number";
  const std::vector<Json> lockstep = in_lockstep("give_mug", seeds);
  ASSERT_EQ(lockstep.size(), static_cast<std::size_t>(seeds));
  EXPECT_GE(successes(lockstep), at_least) << "in lock-step";
  int done = 0, agreed = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Json report = over_dds("give_mug", seed);
    const std::string what = "seed " + std::to_string(seed);
    const bool success = report["success"];
    std::printf("%s: %s, lock-step %s %s\n", what.c_str(), success ? "done" : "failed",
                lockstep[static_cast<std::size_t>(seed - 1)]["success"].dump().c_str(),
                report["failure"].dump().c_str());
    done += success;
    agreed += success == lockstep[static_cast<std::size_t>(seed - 1)]["success"].get<bool>();
    if (!report.contains("oracle")) continue;
    expect_bounded(report, what);
    EXPECT_EQ(report["oracle"]["limit_violations"], 0) << what;
    EXPECT_EQ(report["oracle"]["commanders"], 1) << what;
    if (!success) continue;
    EXPECT_GE(report["oracle"]["max_lifted_m"].get<double>(), 0.10) << what;
    EXPECT_GE(report["oracle"]["human_contact_before_release_s"].get<double>(), 0.2) << what;
    EXPECT_GE(report["oracle"]["human_alone_s"].get<double>(), 1.0) << what;
  }
  EXPECT_GE(done, at_least) << "over DDS";
  EXPECT_GE(agreed, at_least);
}

void expect_failure(const Json& line, const std::string& what) {
  EXPECT_FALSE(line["success"].get<bool>()) << what;
  EXPECT_FALSE(line["failure"].get<std::string>().empty()) << what;
  expect_bounded(line, what);
}

constexpr const char* kMutants[] = {"give_mug_still", "give_mug_no_release"};

TEST(Mutants, fail_with_a_reason) {
  for (const char* scenario : kMutants) {
    for (const Json& line : in_lockstep(scenario, 3)) {
      expect_failure(line, std::string(scenario) + " seed " + line["seed"].dump());
      EXPECT_FALSE(line["reason"].get<std::string>().empty()) << scenario;
    }
  }
}

/// Long enough for a person who takes the mug: it is lifted and offered, so that the only failure
/// is the injected fault.
TEST(Handover, mutants_fail_over_dds_too) {
  for (const char* scenario : kMutants) {
    const Json report = over_dds(scenario, 1, "25");
    const std::string what = std::string(scenario) + " over DDS";
    expect_failure(report, what);
    if (report.contains("oracle")) {
      EXPECT_GE(report["oracle"]["max_lifted_m"].get<double>(), 0.10)
          << what << ": " << report["failure"];
    }
  }
}

TEST(Recorded, people_take_it_too) {
  if (!test::reference_data("motion/kth_handover")) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const std::vector<Json> lines = in_lockstep("give_mug_recorded", 10);
  for (const Json& line : lines) expect_bounded(line, "recorded, seed " + line["seed"].dump());
  EXPECT_GE(successes(lines), 8);
}

}  // namespace
}  // namespace handsel::handover_test
