// SPDX-License-Identifier: Apache-2.0
// A person puts the object elsewhere while the robot reaches for it: the head, which carries the
// only camera that sees objects, finds the object again, and the robot lifts it from there. The
// whole system in lock-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <vector>

#include "common/config/resources.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/edited_settings.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::moved_object_test {
namespace {

const std::string kScenario = "lift_mug_moved";

struct Performance {
  bool succeeded{};
  std::string reason;
  double lifted{};                 ///< max height above its places [m]
  std::optional<double> found_in;  ///< from the rest at the new place until the scene has it [s]
  std::uint64_t ssm_violations{}, collisions{};
};

/// Returns the shipped scenario, in which the camera on the head does not observe the mug while it
/// is put elsewhere.
std::string unobserved_scenario() {
  std::ifstream in(scenario_file(kScenario));
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string camera = "occlusion: true";
  text.insert(text.find(camera) + camera.size(), " faults { kind: BLIND at: 1.2 length: 9 }");
  const std::string view = "fov_horizontal: 1.2 fov_vertical: 1.0";
  text.replace(text.find(view), view.size(), "fov_horizontal: 0.7 fov_vertical: 0.6");
  return text;
}

/// Performs a scenario with settings.
Performance run(const std::string& file, std::uint64_t seed,
                const test::EditedSettings& settings = {}) {
  config::Scenario scenario;
  load_text_proto(file, scenario);
  const Vector3 p_start(scenario.objects(0).pose().xyz().x(), scenario.objects(0).pose().xyz().y(),
                        0);
  LockstepSystem system(system_context(file, "", seed, settings.folder()));
  Performance run;
  std::optional<TimePoint> stands_since;
  bool was_carried = false;
  system.bus().subscribe<GroundTruth>([&](const GroundTruth& truth, const Receipt& r) {
    was_carried = was_carried || truth.carrier == "human";
    if (was_carried && truth.carrier == "surface" && !stands_since) stands_since = r.arrival;
  });
  system.bus().subscribe<Scene>([&](const Scene& scene, const Receipt& r) {
    for (const SceneObject& object : scene.objects)
      if (stands_since && !run.found_in && object.holder == Holder::surface && object.age < 0.2 &&
          (object.T_world_object.translation() - p_start).head<2>().norm() > 0.3)
        run.found_in = to_seconds(r.arrival - *stands_since);
  });
  Performer performer(system.bus(), system.observer(), scenario, 0,
                      [&] { return not_ready(system.snapshot(), false).empty(); });
  system.network().run_until([&] { return performer.finished(); }, TimePoint(from_seconds(120)));
  run.succeeded = performer.finished() && performer.succeeded();
  if (performer.finished()) run.reason = performer.outcomes().back().reason;
  const GroundTruth& truth = system.snapshot().ground_truth.sample;
  run.lifted = truth.max_lifted;
  run.ssm_violations = truth.ssm_violations;
  run.collisions = truth.self_or_scene_collisions;
  return run;
}

TEST(MovedObject, is_found_again_and_lifted_from_where_a_person_has_put_it) {
  const char* runs = std::getenv("HANDSEL_RUNS");
  const int count = runs == nullptr ? 2 : std::atoi(runs);
  int succeeded = 0;
  std::vector<double> found_in;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = 1 + static_cast<std::uint64_t>(i);
    const Performance one = run(scenario_file(kScenario), seed);
    std::printf("seed %llu: %s, found in %.2f s %s\n", static_cast<unsigned long long>(seed),
                one.succeeded ? "lifted" : "failed", one.found_in.value_or(-1), one.reason.c_str());
    std::fflush(stdout);
    succeeded += one.succeeded;
    if (one.found_in) found_in.push_back(*one.found_in);
    EXPECT_EQ(one.ssm_violations, 0u) << seed;
    EXPECT_EQ(one.collisions, 0u) << seed;
  }
  EXPECT_GE(succeeded, std::max(count == 2 ? 2 : 0, 95 * count / 100));
  ASSERT_FALSE(found_in.empty());
  std::sort(found_in.begin(), found_in.end());
  EXPECT_LT(found_in[found_in.size() / 2], 3.0);
}

TEST(MovedObject, is_found_by_the_search_where_nobody_saw_it_put_and_not_without_the_search) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("unobserved.txtpb", unobserved_scenario()).string();
  const Performance searched = run(file, 1);
  EXPECT_TRUE(searched.succeeded) << searched.reason;
  ASSERT_TRUE(searched.found_in);
  std::printf("found in %.2f s\n", *searched.found_in);

  test::EditedSettings staring;  // the gaze stays at the first place of the search
  staring.set("attention.txtpb", "search_dwell", "60");
  const Performance stared = run(file, 1, staring);
  EXPECT_FALSE(stared.succeeded);
  EXPECT_FALSE(stared.found_in);
  EXPECT_NE(stared.reason.find("last seen"), std::string::npos) << stared.reason;
}

}  // namespace
}  // namespace handsel::moved_object_test
