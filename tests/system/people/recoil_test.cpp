// SPDX-License-Identifier: Apache-2.0
// The arm recoils from a person who steps in at 1.6 m/s: a larger distance than without recoil, in
// lock-step (HANDSEL_RUNS: trials of each).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/edited_settings.hpp"

namespace handsel::recoil_test {
namespace {

constexpr int kFirstSeed = 30;

GroundTruth perform(std::uint64_t seed, const std::filesystem::path& settings) {
  config::Scenario scenario;
  load_text_proto(scenario_file("step_in"), scenario);
  LockstepSystem system(system_context("step_in", "", seed, settings));
  Performer performer(system.bus(), system.observer(), scenario, 0,
                      [&] { return not_ready(system.snapshot(), false).empty(); });
  system.network().run_until([&] { return performer.finished(); }, TimePoint(from_seconds(200)));
  EXPECT_TRUE(performer.succeeded()) << "seed " << seed;
  return system.snapshot().ground_truth.sample;
}

TEST(Recoil, keeps_a_person_who_steps_in_farther_away) {
  const char* value = std::getenv("HANDSEL_RUNS");
  const int runs = value == nullptr ? 2 : std::atoi(value);
  test::EditedSettings without;
  without.set("attention.txtpb", "recoil_factor", "0");
  without.set("trajectory_controller.txtpb", "retreat_reach", "0");
  int farther = 0, nearer = 0;
  for (int seed = kFirstSeed; seed < kFirstSeed + runs; ++seed) {
    const GroundTruth with_recoil = perform(static_cast<std::uint64_t>(seed), {});
    const GroundTruth no_recoil = perform(static_cast<std::uint64_t>(seed), without.folder());
    EXPECT_EQ(with_recoil.ssm_violations, 0u) << "seed " << seed;
    EXPECT_EQ(with_recoil.limit_violations, 0u) << "seed " << seed;
    EXPECT_EQ(with_recoil.self_or_scene_collisions, 0u) << "seed " << seed;
    const double gain = with_recoil.min_separation - no_recoil.min_separation;
    farther += gain > 0.005;
    nearer += gain < -0.005;
    std::printf("seed %d: %.3f m, without recoil %.3f m\n", seed, with_recoil.min_separation,
                no_recoil.min_separation);
    std::fflush(stdout);
  }
  EXPECT_GT(farther, nearer);
}

}  // namespace
}  // namespace handsel::recoil_test
