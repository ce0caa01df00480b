// SPDX-License-Identifier: Apache-2.0
// A table with six objects is cleared while a person comes and takes one of them; the final places
// are those of the emulated sensors.
#include <gtest/gtest.h>

#include <map>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"

namespace handsel::clear_table_test {
namespace {

bool stands_on(const config::BoxDescription& box, const Vector3& p) {
  const auto& middle = box.pose().xyz();
  const double above = p.z() - middle.z() - box.size().z() / 2;
  return std::abs(p.x() - middle.x()) < box.size().x() / 2 &&
         std::abs(p.y() - middle.y()) < box.size().y() / 2 && above > 0 && above < 0.2;
}

TEST(ClearTable, five_of_six_things_are_put_away_while_a_person_takes_one) {
  const std::string name = "clear_table_shared";
  config::Scenario scenario;
  load_text_proto(scenario_file(name), scenario);
  const char* seeds = std::getenv("HANDSEL_RUNS");
  for (std::uint64_t seed = 11;
       seed < 11 + (seeds == nullptr ? 1 : std::strtoull(seeds, nullptr, 10)); ++seed) {
    LockstepSystem system(name, "", seed);
    std::map<std::string, Vector3> at;
    system.bus().subscribe<ObjectObservation>([&](const ObjectObservation& seen, const Receipt&) {
      for (const ObservedObject& object : seen.objects)
        at[object.id] = object.T_world_object.translation();
    });
    Performer performer(system.bus(), system.observer(), scenario, 0,
                        [&] { return not_ready(system.snapshot(), false).empty(); });
    system.network().run_until([&] { return performer.finished(); }, TimePoint(from_seconds(500)));
    ASSERT_TRUE(performer.finished());
    const std::string what =
        "seed " + std::to_string(seed) + ": " + performer.outcomes().back().reason;
    EXPECT_TRUE(performer.succeeded()) << what;
    ASSERT_EQ(at.size(), 6u);
    for (const auto& [object, p] : at) {
      const bool taken = object == "bottle";
      EXPECT_EQ(stands_on(scenario.boxes(1), p), !taken)
          << what << ", " << object << " is at " << p.transpose();
      EXPECT_FALSE(stands_on(scenario.boxes(0), p))
          << what << ", " << object << " is still on the table";
      EXPECT_EQ(p.x() > 1.5, taken)
          << "anna goes with what she takes; " << object << " is at " << p.transpose();
    }
    const GroundTruth& ground_truth = system.snapshot().ground_truth.sample;
    EXPECT_EQ(ground_truth.ssm_violations, 0u) << what;
    EXPECT_EQ(ground_truth.limit_violations, 0u) << what;
    EXPECT_EQ(ground_truth.self_or_scene_collisions, 0u) << what;
    EXPECT_FALSE(ground_truth.dropped) << what;
    std::printf("seed %llu: cleared in %.0f s\n", static_cast<unsigned long long>(seed),
                performer.duration());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace handsel::clear_table_test
