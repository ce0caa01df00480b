// SPDX-License-Identifier: Apache-2.0
// The give task with realistic sensors and with temporarily wrong data; checked by the simulator's
// oracle, in lock-step.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

#include <google/protobuf/text_format.h>
#include <nlohmann/json.hpp>

#include "common/config/resources.hpp"
#include "common/config/schema/scenario.pb.h"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/trial.hpp"

namespace handsel::rough_sensors_test {
namespace {

using Json = nlohmann::json;

/// give_mug with its body tracker changed, as a file of its own.
class Changed {
 public:
  explicit Changed(const std::function<void(config::SensorDescription&)>& change) {
    config::Scenario scenario;
    load_text_proto(scenario_file("give_mug"), scenario);
    change(*scenario.mutable_human_sensors(0));
    std::string text;
    google::protobuf::TextFormat::PrintToString(scenario, &text);
    static int number = 0;
    path_ = std::filesystem::temp_directory_path() / ("handsel-rough-" + std::to_string(getpid()) +
                                                      "-" + std::to_string(++number) + ".txtpb");
    std::ofstream(path_) << text;
  }
  ~Changed() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::vector<Json> trials(const std::string& scenario, int first, int count) {
  std::vector<Trial> all;
  NodeContext context = system_context(scenario, "", 1);
  for (int seed = first; seed < first + count; ++seed) {
    context.seed = static_cast<std::uint64_t>(seed);
    all.push_back({context, {.scenario = scenario}});
  }
  std::vector<Json> lines;
  EXPECT_TRUE(run_trials(all, 2, [&](const Json& line) { lines.push_back(line); }))
      << "a trial crashed";
  return lines;
}

int successes(const std::vector<Json>& lines) {
  int count = 0;
  for (const Json& line : lines) {
    EXPECT_EQ(line["ssm_violations"], 0) << "seed " << line["seed"];
    EXPECT_EQ(line["limit_violations"], 0) << "seed " << line["seed"];
    count += line["success"].get<bool>();
    std::printf("seed %s: %s %s %s s\n", line["seed"].dump().c_str(),
                line["success"].dump().c_str(), line["reason"].dump().c_str(),
                line["duration_s"].dump().c_str());
  }
  return count;
}

TEST(RoughSensors, the_give_succeeds) {
  const std::vector<Json> lines = trials("give_mug_rough", 1, 3);
  EXPECT_EQ(successes(lines), 3);
}

TEST(RoughSensorsTen, the_give_succeeds_for_nine_of_ten_seeds) {
  EXPECT_GE(successes(trials("give_mug_rough", 1, 10)), 9);
  const Changed plain([](config::SensorDescription& sensor) {
    sensor.set_latency(0.06);
    sensor.set_noise(0.01);
    sensor.set_dropout(0.05);
  });
  EXPECT_GE(successes(trials(plain.path(), 1, 10)), 9) << "30 Hz, 60 ms, 1 cm, 5 %";
}

struct Standstill {
  bool moved_before{};  ///< in the second before the fault
  double last_moved{};  ///< the arm, after the fault began [s]
  bool moved_again{};   ///< after it ended
  std::uint64_t ssm_violations{};
};

/// Runs the give task with seed 3; calls back with every sample of ground truth and whether the arm
/// moves along a trajectory.
std::uint64_t give(const std::string& scenario, double seconds,
                   const std::function<void(const GroundTruth&, bool)>& see) {
  LockstepSystem system(scenario, "", 3);
  auto goals = system.bus().advertise<TaskGoal>();
  system.bus().after(from_seconds(0.6), [&](TimePoint) {
    goals->publish({.id = 1, .kind = TaskKind::give, .object = "mug", .human = "anna"});
  });
  system.observer().on_sample([&](const Snapshot& snapshot, TimePoint) {
    see(snapshot.ground_truth.sample, std::abs(snapshot.active.sample.speed_factor) >= 1e-3);
  });
  system.network().run_for(from_seconds(seconds));
  return system.snapshot().ground_truth.sample.ssm_violations;
}

/// Returns the middle of the longest motion with the mug in a run without faults [s]: the same seed
/// gives the same bits until a fault.
double on_its_way() {
  const Changed scenario([](config::SensorDescription&) {});
  double begun = -1, last = -1, longest = 0, middle = 0;
  give(scenario.path(), 30, [&](const GroundTruth& ground_truth, bool moves) {
    if (!moves || ground_truth.carrier != "robot") return;
    if (ground_truth.sim_time - last > 0.1) begun = ground_truth.sim_time;
    last = ground_truth.sim_time;
    if (last - begun <= longest) return;
    longest = last - begun;
    middle = (begun + last) / 2;
  });
  return middle;
}

Standstill with_fault(config::SensorFaultKind kind, double at, double length) {
  const Changed scenario([&](config::SensorDescription& sensor) {
    auto* fault = sensor.add_faults();
    fault->set_kind(kind);
    fault->set_at(at);
    fault->set_length(length);
    fault->set_delay(2);
  });
  Standstill out;
  out.ssm_violations =
      give(scenario.path(), at + length + 15, [&](const GroundTruth& ground_truth, bool moves) {
        if (!moves) return;
        const double t = ground_truth.sim_time - at;
        if (t > -1 && t < 0) out.moved_before = true;
        if (t > 0 && t < length) out.last_moved = t;
        if (t > length + 0.5) out.moved_again = true;
      });
  return out;
}

TEST(RoughSensors, frozen_repeated_late_or_missing_data_stop_the_robot_in_time) {
  const double at = on_its_way();
  ASSERT_GT(at, 0) << "the mug was never on its way";
  for (const auto kind : {config::FROZEN, config::REPEATED, config::GAP, config::LATE}) {
    const Standstill s = with_fault(kind, at, 4.0);
    const std::string name = config::SensorFaultKind_Name(kind);
    std::printf("%s: last moved %.2f s after it began\n", name.c_str(), s.last_moved);
    EXPECT_TRUE(s.moved_before) << name << ": nothing was stopped";
    EXPECT_LT(s.last_moved, 1.0) << name;
    EXPECT_TRUE(s.moved_again) << name << ": it goes on when the data are good again";
    EXPECT_EQ(s.ssm_violations, 0u) << name;
  }
}

}  // namespace
}  // namespace handsel::rough_sensors_test
