// SPDX-License-Identifier: Apache-2.0
// The adaptive clock by margin in the running system: AVOID samples passing people at the period of
// the margin, and during a longer period nobody is nearer than the margin permits. The whole system
// in lock-step; distances of the simulator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/edited_settings.hpp"

namespace handsel::margin_law_test {
namespace {

// As in attention.txtpb: period [s], distance [m], speeds [m/s], age of the data [s].
constexpr double kPMin = 0.04, kPMax = 0.8, kUse = 0.8, kDistance = 0.6, kPerson = 1.6,
                 kRobot = 0.4, kAge = 0.1, kHalfTick = 0.005;

/// Sets the clock of AVOID to MARGIN.
void set_margin(const std::filesystem::path& folder) {
  std::stringstream text;
  text << std::ifstream(folder / "attention.txtpb").rdbuf();
  const std::regex law("(name: \"avoid\" *law: )[A-Z]+");
  const std::string before = text.str();
  ASSERT_TRUE(std::regex_search(before, law));
  std::ofstream(folder / "attention.txtpb") << std::regex_replace(before, law, "$1MARGIN");
}

TEST(MarginLaw, is_what_the_running_system_looks_by) {
  test::EditedSettings settings;
  set_margin(settings.folder());
  config::Scenario scenario;
  load_text_proto(scenario_file("place_with_passers_by"), scenario);
  LockstepSystem system(system_context("place_with_passers_by", "", 100003, settings.folder()));
  Performer performer(system.bus(), system.observer(), scenario, 0,
                      [&] { return not_ready(system.snapshot(), false).empty(); });
  double separation = std::numeric_limits<double>::infinity(), nearest = separation;
  int samples = 0, adapted = 0, wrong = 0, too_near = 0;
  system.bus().subscribe<GroundTruth>([&](const GroundTruth& truth, const Receipt&) {
    separation = truth.separation;
    nearest = std::min(nearest, separation);
  });
  system.bus().subscribe<AttentionState>([&](const AttentionState& state, const Receipt&) {
    constexpr double kBetweenSamples = 0.02;  // period of the simulator's distance [s]
    for (const BehaviourState& avoid : state.behaviours) {
      if (avoid.name != "avoid" || avoid.activations == 0) continue;
      const double wanted =
          kUse * (avoid.stimulus - kDistance) / (kPerson + kRobot) - kAge - kHalfTick;
      ++samples;
      wrong += std::abs(avoid.period - std::clamp(wanted, kPMin, kPMax)) > 1e-6;
      if (avoid.period <= kPMin + 1e-9) continue;
      adapted += avoid.period < kPMax - 1e-9;
      too_near += separation < kDistance - (kPerson + kRobot) * kBetweenSamples;
    }
  });
  system.network().run_until([&] { return performer.finished(); }, TimePoint(from_seconds(200)));
  EXPECT_TRUE(performer.succeeded());
  std::printf("%d samples, %d between the limits, nearest person %.3f m\n", samples, adapted,
              nearest);
  EXPECT_GT(samples, 50);
  EXPECT_GT(adapted, 5) << "nobody came by";
  EXPECT_EQ(wrong, 0) << "periods that are not those of the law";
  EXPECT_EQ(too_near, 0) << "the margin was used up between two looks";
}

}  // namespace
}  // namespace handsel::margin_law_test
