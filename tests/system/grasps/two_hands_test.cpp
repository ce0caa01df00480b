// SPDX-License-Identifier: Apache-2.0
// Two hands on the running system, all components in lock-step with the simulator: pick-and-place
// goals without a feasible grasp of one hand, and a tray too heavy for one hand. HANDSEL_GOALS:
// some of the five goals, e.g. "3 4"; HANDSEL_SEEDS: of the tray, e.g. "1 2".
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>

#include "common/config/resources.hpp"
#include "common/config/schema/scenario.pb.h"
#include "common/messages/names.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "tests/support/duo_stage.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::two_hands_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Trip {
  TaskStatus task;
  GroundTruth ground_truth;
  std::vector<std::string> phases;
  Pose T_start{Pose::Identity()};
  double max_tilt{};  ///< of the object's z axis from up, ever [rad]
  double seconds{};
  std::uint64_t truths{};  ///< number of reports of ground truth
};

double tilt(const Pose& T) { return std::acos(std::clamp(T.linear()(2, 2), -1.0, 1.0)); }

config::Scenario scenario_text(const std::string& scenario) {
  config::Scenario text;
  load_text_proto(std::string(HANDSEL_SOURCE_DIR) + "/sim/scenarios/" + scenario + ".txtpb", text);
  return text;
}

/// Writes settings in which the simulator publishes ground truth after every step.
void settings_of_every_step(const std::filesystem::path& folder) {
  const std::filesystem::path from = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/config";
  std::filesystem::copy(
      from, folder,
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  std::ifstream in(from / "sim.txtpb");
  std::ofstream out(folder / "sim.txtpb");
  double step = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("step:", 0) == 0) step = std::stod(line.substr(5));
    if (line.rfind("ground_truth_rate:", 0) != 0) out << line << "\n";
  }
  out << "ground_truth_rate: " << std::lround(1 / step) << "\n";
}

Trip perform(const std::string& scenario, std::uint64_t seed, TaskKind kind = TaskKind::place,
             const std::filesystem::path& settings = {}) {
  LockstepSystem system(system_context(scenario, "", seed, settings));
  const config::Scenario text = scenario_text(scenario);
  Trip run;
  Bus& seat = system.bus();
  auto goals = seat.advertise<TaskGoal>();
  bool started = false;
  seat.subscribe<ActionStatus>([&](const ActionStatus& s, const Receipt&) {
    const bool runs = s.state == ActionState::running && s.phase != ActionPhase::none;
    if (runs && (run.phases.empty() || run.phases.back() != phase_text(s)))
      run.phases.push_back(phase_text(s));
  });
  seat.subscribe<GroundTruth>([&](const GroundTruth& t, const Receipt&) {
    if (!started) run.T_start = t.T_world_object;
    run.ground_truth = t;
    ++run.truths;
    run.max_tilt = std::max(run.max_tilt, tilt(t.T_world_object));
  });
  seat.after(from_seconds(3.0), [&](TimePoint) {
    started = true;
    goals->publish({.id = 1,
                    .kind = kind,
                    .object = text.tasks(0).object(),
                    .surface = kind == TaskKind::place ? text.tasks(0).surface() : ""});
  });
  const auto over = [&] {
    const auto& tasks = system.snapshot().tasks;
    const auto at = tasks.find(1);
    return at != tasks.end() &&
           (at->second.state == TaskState::succeeded || at->second.state >= TaskState::failed);
  };
  system.network().run_until(over, TimePoint(from_seconds(text.timeout())));
  if (system.snapshot().tasks.count(1) != 0) run.task = system.snapshot().tasks.at(1);
  run.seconds = to_seconds(system.now().time_since_epoch()) - 3.0;
  return run;
}

void expect_put(const Trip& run, const std::string& scenario) {
  const config::Scenario text = scenario_text(scenario);
  std::string phases;
  for (const std::string& phase : run.phases) phases += (phases.empty() ? "" : ", ") + phase;
  SCOPED_TRACE(scenario + ": " + phases);
  EXPECT_EQ(run.task.state, TaskState::succeeded) << run.task.reason;
  const auto box = std::find_if(text.boxes().begin(), text.boxes().end(),
                                [&](const auto& b) { return b.id() == text.tasks(0).surface(); });
  ASSERT_NE(box, text.boxes().end());
  const Vector3 p = run.ground_truth.T_world_object.translation();
  const ObjectModel& model = *grasp_planner::object_model(text.objects(0).model());
  EXPECT_LT(std::abs(p.x() - box->pose().xyz().x()), box->size().x() / 2);
  EXPECT_LT(std::abs(p.y() - box->pose().xyz().y()), box->size().y() / 2);
  EXPECT_NEAR(p.z(), box->pose().xyz().z() + box->size().z() / 2 + model.height_above_support,
              0.01);
  EXPECT_LT(tilt(run.ground_truth.T_world_object), 3 * kDegree);
  EXPECT_FALSE(run.ground_truth.dropped);
  EXPECT_EQ(run.ground_truth.carrier, "surface");
  EXPECT_EQ(run.ground_truth.self_or_scene_collisions, 0U);
  EXPECT_EQ(run.ground_truth.limit_violations, 0U);
}

TEST(TwoHands, pick_and_place_that_one_hand_cannot_do_goes_from_hand_to_hand) {
  const char* asked = std::getenv("HANDSEL_GOALS");
  std::istringstream goals(asked != nullptr ? asked : "1 2 3 4 5");
  const grasp_planner::DuoStage stage;
  for (std::string k; goals >> k;) {
    const std::string scenario = "duo_regrasp_" + k;
    const Trip run = perform(scenario, 1);
    std::printf("%s: %s after %.1f s\n", scenario.c_str(),
                run.task.state == TaskState::succeeded ? "done" : run.task.reason.c_str(),
                run.seconds);
    expect_put(run, scenario);
    EXPECT_NE(std::find(run.phases.begin(), run.phases.end(), "carry to the other hand"),
              run.phases.end());
    // Neither hand alone: no grasp of its list is feasible at both start and goal.
    const config::Scenario text = scenario_text(scenario);
    Scene scene = stage.scene();
    scene.boxes.clear();
    for (const auto& b : text.boxes())
      scene.boxes.push_back(
          {b.id(),
           make_pose({b.pose().xyz().x(), b.pose().xyz().y(), b.pose().xyz().z()}),
           {b.size().x(), b.size().y(), b.size().z()},
           true});
    const std::string& object = text.objects(0).model();
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const auto arms = stage.arms(object);
      grasp_planner::RegraspPlanner alone(
          stage.robot, {arms[arm]}, *grasp_planner::hand_on_object("sah", object, 60, 144).object,
          [](const std::string& name) { return grasp_planner::object_model(name); }, scene,
          "thing");
      grasp_planner::RegraspTask task;
      task.start.T_world_object = run.T_start;
      task.goal.T_world_object = run.ground_truth.T_world_object;
      EXPECT_FALSE(alone.plan(task).solved)
          << scenario << ": " << arms[arm].arm.name << " can do it alone";
    }
  }
}

TEST(TwoHands, a_tray_too_heavy_for_one_is_carried_level_by_both) {
  const char* asked = std::getenv("HANDSEL_SEEDS");
  std::istringstream seeds(asked != nullptr ? asked : "1 2 3 4");
  const test::TemporaryFolder folder;
  settings_of_every_step(folder.path());
  for (std::uint64_t seed = 0; seeds >> seed;) {
    const Trip run = perform("duo_tray", seed, TaskKind::place, folder.path());
    std::printf("duo_tray, seed %d: %s after %.1f s, tilted by %.2f degrees at most in %d steps\n",
                static_cast<int>(seed),
                run.task.state == TaskState::succeeded ? "done" : run.task.reason.c_str(),
                run.seconds, run.max_tilt / kDegree, static_cast<int>(run.truths));
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_put(run, "duo_tray");
    EXPECT_GT(run.ground_truth.max_lifted, 0.15) << "over the edge of the stand";
    EXPECT_LT(run.max_tilt, 5 * kDegree);
    EXPECT_EQ(run.ground_truth.constraint_time, 0.0) << "contact alone holds what is heavy";
    EXPECT_GT(static_cast<double>(run.truths), 990 * run.seconds);
  }
}

TEST(TwoHands, one_hand_does_not_take_what_is_too_heavy_for_it) {
  const Trip run = perform("duo_tray", 1, TaskKind::pick);
  EXPECT_EQ(run.task.state, TaskState::refused);
  EXPECT_NE(run.task.reason.find("too heavy for one hand"), std::string::npos) << run.task.reason;
  EXPECT_LT((run.ground_truth.T_world_object.translation() - run.T_start.translation()).norm(),
            1e-3);
}

}  // namespace
}  // namespace handsel::two_hands_test
