// SPDX-License-Identifier: Apache-2.0
// `handsel eval` from the user's side: several conditions with the same seeds, merged shards, and
// the same trial on another machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test::eval_test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;
namespace fs = std::filesystem;

const std::string kHandsel = HANDSEL_COMMAND;

std::vector<Json> lines_of(const std::string& text) {
  std::vector<Json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(Json::parse(line));
  return lines;
}

TEST(Eval, a_replayed_trial_is_the_same_bit_for_bit_from_another_folder_too) {
  const TemporaryFolder elsewhere;
  const fs::path root = elsewhere.path();
  fs::create_directories(root / "bin");
  fs::copy(kHandsel, root / "bin/handsel");
  fs::copy(HANDSEL_SOURCE_DIR "/deploy", root / "deploy", fs::copy_options::recursive);
  fs::create_directories(root / "sim");
  fs::copy(HANDSEL_SOURCE_DIR "/sim/scenarios", root / "sim/scenarios",
           fs::copy_options::recursive);
  const std::string arguments = " eval --scenario give_mug --replay 5 --timeout 5";
  const Outcome here = shell(kHandsel + arguments),
                there = shell((root / "bin/handsel").string() + arguments);
  const Json a = lines_of(here.out).at(0), b = lines_of(there.out).at(0);
  EXPECT_EQ(a["output_hash"], b["output_hash"]);
  EXPECT_EQ(a["hash"], b["hash"]);
  EXPECT_THAT(here.err, HasSubstr("hash of all outputs " + a["output_hash"].get<std::string>()));
  EXPECT_GT(a["events"].get<int>(), 10000);
  const Json other =
      lines_of(shell(kHandsel + " eval --scenario give_mug --replay 6 --timeout 5").out).at(0);
  EXPECT_NE(other["output_hash"], a["output_hash"]);
  const std::string file = (root / "trial.mcap").string();
  EXPECT_EQ(lines_of(shell(kHandsel + arguments + " --record " + file).out).at(0)["output_hash"],
            a["output_hash"])
      << "who listens changes it";
  EXPECT_GT(fs::file_size(file), 1'000'000u);
}

TEST(Eval, a_tray_too_heavy_and_too_wide_for_one_hand_is_given_with_both) {
  const Outcome run = shell(kHandsel + " eval --scenario give_tray --replay 2");
  const Json trial = lines_of(run.out).at(0);
  EXPECT_TRUE(trial["success"].get<bool>()) << run.out.substr(0, 1000);
  EXPECT_EQ(trial["contact_ratio"].get<double>(), 1) << "without the help of the grasp constraint";
}

TEST(Eval, conditions_share_their_seeds_and_come_in_a_drawn_order) {
  const TemporaryFolder folder;
  const Outcome outcome = shell(
      kHandsel +
      " eval --scenario give_mug --trials 4 --seed 3 --timeout 0.3 --jobs 2 --participant p07 " +
      "--attention adaptive max off fixed:0.5 --report " + (folder.path() / "study").string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::map<int, std::set<std::string>> conditions;
  std::set<std::string> first;
  for (const Json& line : lines_of(outcome.out)) {
    if (conditions[line["seed"]].empty()) first.insert(line["condition"]);
    conditions[line["seed"]].insert(line["condition"]);
    EXPECT_EQ(line["participant"], "p07");
    if (line["condition"] == "max") {
      EXPECT_EQ(line["activations"], line["activations_at_pmin"]);
      EXPECT_NEAR(line["work_period_s"]["forecast"].get<double>(), 0.02, 1e-9);
    }
    if (line["condition"] == "off") {
      EXPECT_EQ(line["activations"], 0);
    }
  }
  EXPECT_EQ(conditions.size(), 4u);
  for (const auto& [seed, names] : conditions) EXPECT_EQ(names.size(), 4u) << seed;
  EXPECT_GT(first.size(), 1u) << "always in the same order";
  for (const char* file : {"comparison.jsonl", "trials.csv", "table.txt", "give_mug.svg"})
    EXPECT_GT(fs::file_size(folder.path() / "study" / file), 100u) << file;
}

TEST(Eval, shards_come_together_as_if_they_had_been_one) {
  const TemporaryFolder folder;
  const std::string trials =
      kHandsel +
      " eval --scenario give_mug --trials 3 --seed 3 --timeout 0.3 --attention adaptive max ";
  std::string files;
  for (const char* shard : {"0/2", "1/2"}) {
    const std::string file = (folder.path() / (std::string(1, shard[0]) + ".jsonl")).string();
    EXPECT_EQ(shell(trials + "--shard " + shard + " --out " + file).exit_code, 0);
    files += " " + file;
  }
  EXPECT_EQ(
      shell(trials + "--out /dev/null --report " + (folder.path() / "whole").string()).exit_code,
      0);
  EXPECT_EQ(
      shell(kHandsel + " eval --from" + files + " --report " + (folder.path() / "parts").string())
          .exit_code,
      0);
  const auto runs = [&](const char* name) {
    std::ostringstream text;
    text << std::ifstream(folder.path() / name / "comparison.jsonl").rdbuf();
    for (const Json& row : lines_of(text.str()))
      if (row["measure"] == "runs") return row;
    throw std::logic_error("no row");
  };
  EXPECT_EQ(runs("whole"), runs("parts"));
  EXPECT_EQ(runs("whole")["pairs"], 3);
}

TEST(Eval, a_scenario_that_cannot_be_performed_is_refused) {
  const TemporaryFolder folder;
  const fs::path scenario =
      folder.write("unable.txtpb",
                   "name: \"unable\" robot: \"jido\" people { id: \"ben\" behaviour: TAKER "
                   "approach_from: 1 steps_in { speed: 1 } }");
  const Outcome outcome = shell(kHandsel + " eval --trials 1 --scenario " + scenario.string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr("ben steps in but is not STILL"));
}

TEST(Eval, settings_that_contradict_each_other_are_refused_and_lines_are_kept) {
  const TemporaryFolder folder;
  const fs::path lines = folder.write("lines.jsonl", "kept");
  const Outcome outcome = shell(kHandsel + " eval --trials 3 --set sim.external_min_motion=0.2" +
                                " --out " + lines.string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("external_min_motion: must be at most external_max_motion"));
  std::ostringstream text;
  text << std::ifstream(lines).rdbuf();
  EXPECT_EQ(text.str(), "kept");
}

TEST(Eval, a_mode_that_cannot_be_is_refused) {
  const auto refused = [](const std::string& arguments, const std::string& says) {
    const Outcome outcome = shell(kHandsel + " eval " + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says));
  };
  refused("--attention some", "is none of adaptive, max, mean, off, fixed:RATIO");
  refused("--attention fixed:2", "must be a number from 0 to 1");
  refused("--replay 4 --attention max off", "name one mode and one law");
  refused("--trials 2 --record x.mcap", "--record is for the one trial of --replay");
}

}  // namespace
}  // namespace handsel::test::eval_test
