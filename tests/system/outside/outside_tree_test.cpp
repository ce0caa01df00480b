// SPDX-License-Identifier: Apache-2.0
// Files of a user outside the tree: settings over the shipped ones, a search path, and the
// arguments of the processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/config/overlay.hpp"
#include "deploy/handsel/offline/settings_list.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::outside_tree_test {
namespace {

using testing::HasSubstr;
using testing::Not;

class OutsideTheTree : public testing::Test {
 protected:
  test::Outcome handsel(const std::string& arguments) const {
    return test::shell("cd " + folder.path().string() + " && " + HANDSEL_COMMAND + " " + arguments);
  }
  std::string hash_of(const std::string& arguments) const {
    const test::Outcome outcome = handsel("eval --scenario give_mug --replay 3 " + arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["output_hash"];
  }
  /// The shipped value of a setting.
  static std::string list_value(const std::string& path) {
    for (const ListedSetting& one : list_settings(path.substr(0, path.find('.')), false))
      if (one.path == path) return one.value;
    return "not there";
  }
  test::TemporaryFolder folder;
};

TEST_F(OutsideTheTree, settings_are_shown_with_their_source_and_compared) {
  const auto file = folder.write("mine.txtpb", "spark {\n  grip_force: 4\n}\n");
  const std::string overlay = " --config mine.txtpb --set trajectory_planner.min_jerk_factor=0.5";
  const test::Outcome shown = handsel("config show spark" + overlay);
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("spark.grip_force: 4  # mine.txtpb:2\n"));
  EXPECT_THAT(shown.out, HasSubstr("spark.holding_distance: 0.08  # "));
  EXPECT_THAT(shown.out, HasSubstr("config/spark.txtpb:"));
  const test::Outcome compared = handsel("config diff" + overlay);
  EXPECT_EQ(compared.exit_code, 1) << compared.err;
  EXPECT_EQ(compared.out,
            "spark.grip_force: 3 -> 4  # mine.txtpb:2\n"
            "trajectory_planner.min_jerk_factor: " +
                list_value("trajectory_planner.min_jerk_factor") +
                " -> 0.5  # --set trajectory_planner.min_jerk_factor=0.5\n");
  EXPECT_EQ(handsel("config diff").exit_code, 0);
}

TEST_F(OutsideTheTree, a_wrong_overlay_starts_nothing) {
  folder.write("mine.txtpb", "spark {\n  grip_forc: 4\n}\n");
  for (const char* command : {"up", "run --headless", "eval --trials 1"}) {
    const test::Outcome outcome = handsel(command + std::string(" --config mine.txtpb"));
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr("mine.txtpb:2:grip_forc: is no key of SparkSettings; the "
                                       "nearest is \"grip_force\""));
    EXPECT_THAT(outcome.err, Not(HasSubstr("starting")));
  }
  const test::Outcome outcome = handsel("eval --trials 1 --set spark.grip_force=5000");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--set spark.grip_force=5000: is \"5000\", must be a number "
                                     "in [0, 1000] N"));
}

TEST_F(OutsideTheTree, a_mistyped_command_or_option_is_answered_with_the_nearest) {
  const auto sentence = [&](const std::string& arguments) {
    const test::Outcome outcome = handsel(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    return outcome.err;
  };
  EXPECT_THAT(sentence("evla --trials 1"),
              HasSubstr("no command \"evla\" here; the nearest: eval;"));
  EXPECT_THAT(sentence("config shwo"), HasSubstr("no command \"shwo\" here; the nearest: show;"));
  EXPECT_THAT(sentence("eval --trails 1"),
              HasSubstr("no option \"--trails\" here; the nearest: --trials;"));
  EXPECT_THAT(sentence("run --secnario=give_mug"),
              HasSubstr("no option \"--secnario\" here; the nearest: --scenario;"));
}

TEST_F(OutsideTheTree, every_process_is_started_with_the_overlays) {
  const auto file = folder.write("mine.txtpb", "spark { grip_force: 4 }");
  use_overlays({.files = {file.string()}, .assignments = {"spark.holding_distance=0.05"}});
  for (const ProcessSpec& process : system_processes({})) {
    const auto& arguments = process.arguments;
    for (const std::string& argument : {file.string(), std::string("spark.holding_distance=0.05")})
      EXPECT_NE(std::find(arguments.begin(), arguments.end(), argument), arguments.end())
          << process.name << " " << argument;
  }
  use_overlays({});
}

TEST_F(OutsideTheTree, a_process_takes_overlays_and_refuses_wrong_ones) {
  folder.write("mine.txtpb", "attention { behaviours { name: \"mine\" } }");
  const std::string binary =
      std::filesystem::path(HANDSEL_COMMAND).parent_path().string() + "/handsel_attention";
  const test::Outcome outcome = test::shell("cd " + folder.path().string() + " && " + binary +
                                            " --standby --domain 77 --config mine.txtpb");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("mine.txtpb:p_min: must be given"));
}

TEST_F(OutsideTheTree, a_replay_with_the_same_overlays_repeats_the_trial) {
  folder.write("mine.txtpb", "trajectory_planner { min_jerk_factor: 0.9 }");
  const std::string plain = hash_of(""), mine = hash_of("--config mine.txtpb");
  EXPECT_NE(plain, mine);
  EXPECT_EQ(mine, hash_of("--set trajectory_planner.min_jerk_factor=0.9"));
}

}  // namespace
}  // namespace handsel::outside_tree_test
