// SPDX-License-Identifier: Apache-2.0
// A mobile robot passes a person in a corridor and behind a doorway at a larger distance than on
// the shortest path. In lock-step.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/trial.hpp"
#include "tests/support/processes/edited_settings.hpp"

namespace handsel::passing_test {
namespace {

/// Returns the trial of a seed; `settings`: folder, empty: as shipped.
nlohmann::json pass(std::uint64_t seed, const std::filesystem::path& settings) {
  nlohmann::json trial =
      run_trial(system_context("pass_person", "", seed, settings), {.scenario = "pass_person"});
  std::printf("seed %llu, %s: %s, %.1f s, at least %.2f m, angle to the front %.2f rad\n",
              static_cast<unsigned long long>(seed), trial["drawn"].dump().c_str(),
              trial["success"].get<bool>() ? "done" : "not done", trial["duration_s"].get<double>(),
              trial["min_separation_m"].get<double>(), trial["nearest_angle_rad"].get<double>());
  return trial;
}

TEST(Passing, people_cost_and_are_passed_farther_off_than_on_the_shortest_path) {
  constexpr double kFarther = 0.15;  // min increase of the distance [m]
  test::EditedSettings no_costs;
  no_costs.set("cost.txtpb", "w_safety", "0");
  no_costs.set("cost.txtpb", "w_visibility", "0");
  for (const std::uint64_t seed : {2u, 3u}) {
    const nlohmann::json shipped = pass(seed, {}), shortest = pass(seed, no_costs.folder());
    EXPECT_TRUE(shipped["success"].get<bool>()) << shipped["reason"];
    EXPECT_EQ(shipped["ssm_violations"].get<int>(), 0);
    EXPECT_EQ(shipped["collisions"].get<int>(), 0);
    EXPECT_EQ(shipped["contact_force_n"].get<double>(), 0.0);
    EXPECT_GT(shipped["min_separation_m"].get<double>(),
              shortest["min_separation_m"].get<double>() + kFarther);
  }
}

}  // namespace
}  // namespace handsel::passing_test
