// SPDX-License-Identifier: Apache-2.0
// The whole system in virtual time: the same seed gives the same bits, another seed another run; a
// crash is one failed trial.
#include <gtest/gtest.h>

#include <cmath>

#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/trial.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"

namespace handsel::lockstep_test {
namespace {

struct Trace {
  std::uint64_t hash{};
  std::uint64_t events{};
  bool moved{};
  Vector3 object{Vector3::Zero()};
};

/// The first seconds of a handover.
Trace play(std::uint64_t seed, double seconds) {
  LockstepSystem system("give_mug", "", seed);
  Trace trace;
  auto goals = system.bus().advertise<TaskGoal>();
  system.bus().after(from_seconds(0.6), [&](TimePoint) {
    goals->publish({.id = 1, .kind = TaskKind::give, .object = "mug", .human = "anna"});
  });
  system.observer().on_sample([&](const Snapshot& snapshot, TimePoint) {
    trace.moved = trace.moved || snapshot.ground_truth.sample.robot_moving;
  });
  system.network().run_for(from_seconds(seconds));
  const GroundTruth& ground_truth = system.snapshot().ground_truth.sample;
  trace.hash = ground_truth.hash;
  trace.events = system.network().events();
  trace.object = ground_truth.T_world_object.translation();
  return trace;
}

TEST(Lockstep, every_box_is_ready_within_half_a_second) {
  LockstepSystem system("give_mug", "", 1);
  EXPECT_TRUE(system.network().run_until(
      [&] { return not_ready(system.snapshot(), false).empty(); }, TimePoint(from_seconds(0.5))));
  for (const std::string& missing : not_ready(system.snapshot(), false)) ADD_FAILURE() << missing;
}

TEST(Lockstep, the_same_seed_gives_the_same_bits) {
  const Trace first = play(7, 6.0), second = play(7, 6.0);
  EXPECT_TRUE(first.moved) << "nothing was compared: the arm did not move";
  EXPECT_EQ(first.hash, second.hash);
  EXPECT_EQ(first.events, second.events);
  EXPECT_EQ(first.object, second.object);
}

TEST(Lockstep, all_that_is_sent_is_one_number_and_looking_at_the_work_does_not_change_it) {
  const auto run = [](std::uint64_t seed, bool metered) {
    LockstepSystem system("give_mug", "", seed);
    system.network().hash_outputs();
    if (metered) system.network().meter({"collision_checker"});
    system.network().run_for(std::chrono::seconds(1));
    EXPECT_EQ(system.network().cpu("collision_checker") > 0, metered);
    return system.network().output_hash();
  };
  const std::uint64_t first = run(7, false);
  EXPECT_EQ(first, run(7, true));
  EXPECT_NE(first, run(8, false));
}

TEST(Lockstep, another_seed_gives_another_world) {
  const Trace first = play(7, 1.0), second = play(8, 1.0);
  EXPECT_NE(first.hash, second.hash);
  EXPECT_GT((first.object - second.object).norm(), 1e-3);
}

TEST(Trials, lines_come_in_order_and_a_trial_that_cannot_start_is_one_failure) {
  NodeContext context = system_context("give_mug", "", 1);
  NodeContext broken = context;
  broken.settings = "/nowhere";
  const TrialOptions options{.scenario = "give_mug", .timeout = 0.5};
  std::vector<nlohmann::json> lines;
  EXPECT_FALSE(run_trials({{context, options}, {broken, options}}, 2,
                          [&](const nlohmann::json& line) { lines.push_back(line); }));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["failure"], "timeout");
  EXPECT_EQ(lines[1]["failure"], "error");
  for (const char* field :
       {"scenario", "seed", "attention", "law", "success", "failure", "duration_s",
        "min_separation_m", "ssm_violations", "limit_ratio", "drops", "activations",
        "activations_at_pmin", "reaction_p50_s", "reaction_p99_s", "hash"}) {
    EXPECT_TRUE(lines[0].contains(field)) << field;
  }
}

TEST(Trials, a_crash_is_counted_and_the_rest_still_runs) {
  const NodeContext context = system_context("give_mug", "", 1);
  TrialOptions quick{.scenario = "give_mug", .timeout = 0.2}, crashing = quick;
  crashing.on_event = [](double, const std::string&) { std::abort(); };
  std::vector<nlohmann::json> lines;
  EXPECT_FALSE(run_trials({{context, crashing}, {context, quick}}, 2,
                          [&](const nlohmann::json& line) { lines.push_back(line); }));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["failure"], "crash");
  EXPECT_EQ(lines[1]["failure"], "timeout");
}

TEST(Trials, contact_alone_holds_what_is_given_and_received) {
  for (const char* scenario : {"give_mug", "receive_mug", "give_box_panda"}) {
    const nlohmann::json line = run_trial(system_context(scenario, "", 1), {.scenario = scenario});
    EXPECT_TRUE(line["success"].get<bool>()) << scenario << ": " << line["reason"];
    EXPECT_EQ(line["contact_ratio"], 1.0) << scenario << ": a grasp constraint helped";
    EXPECT_EQ(line["drops"], 0) << scenario;
  }
}

/// Values of Newcombe (1998), table I.
TEST(Trials, wilson_intervals_are_those_of_the_literature) {
  const auto expect = [](int successes, int trials, double low, double high) {
    const auto [a, b] = wilson_interval(successes, trials);
    EXPECT_NEAR(a, low, 5e-5);
    EXPECT_NEAR(b, high, 5e-5);
  };
  expect(81, 263, 0.2553, 0.3662);
  expect(15, 148, 0.0624, 0.1605);
  expect(0, 20, 0.0000, 0.1611);
  expect(1, 29, 0.0061, 0.1718);
}

}  // namespace
}  // namespace handsel::lockstep_test
