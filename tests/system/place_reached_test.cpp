// SPDX-License-Identifier: Apache-2.0
// A person who reaches for an object that the robot is putting down receives the object; a person
// who only passes does not (HANDSEL_RUNS: trials of each).
#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"

namespace handsel::place_reached_test {
namespace {

struct Ending {
  bool given{}, succeeded{};
  std::string reason;
};

Ending perform(const std::string& name, std::uint64_t seed) {
  config::Scenario scenario;
  load_text_proto(scenario_file(name), scenario);
  LockstepSystem system(name, "", seed);
  Performer performer(system.bus(), system.observer(), scenario, 0,
                      [&] { return not_ready(system.snapshot(), false).empty(); });
  system.network().run_until([&] { return performer.finished(); }, TimePoint(from_seconds(200)));
  const GroundTruth& ground_truth = system.snapshot().ground_truth.sample;
  EXPECT_EQ(ground_truth.ssm_violations, 0u) << name << " seed " << seed;
  EXPECT_EQ(ground_truth.limit_violations, 0u) << name << " seed " << seed;
  EXPECT_FALSE(ground_truth.dropped) << name << " seed " << seed;
  return {ground_truth.handover_done, performer.succeeded(),
          performer.outcomes().empty() ? "" : performer.outcomes().back().reason};
}

int count_given(const std::string& name, int runs) {
  int given = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const Ending ending = perform(name, static_cast<std::uint64_t>(seed));
    given += ending.given;
    std::printf("%s seed %d: %s%s\n", name.c_str(), seed, ending.given ? "given" : "put down",
                ending.succeeded ? "" : (", failed: " + ending.reason).c_str());
    std::fflush(stdout);
  }
  return given;
}

int runs() {
  const char* value = std::getenv("HANDSEL_RUNS");
  return value == nullptr ? 1 : std::atoi(value);
}

TEST(PlaceReached, who_reaches_for_it_gets_it) {
  EXPECT_GE(count_given("place_mug_reached", runs()), static_cast<int>(std::ceil(0.95 * runs())));
}

TEST(PlaceReached, who_passes_does_not) { EXPECT_EQ(count_given("place_mug_passed", runs()), 0); }

}  // namespace
}  // namespace handsel::place_reached_test
