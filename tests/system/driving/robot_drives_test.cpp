// SPDX-License-Identifier: Apache-2.0
// A mobile robot in lock-step: past a person, to a sideboard and then to a person, also with
// slipping wheels or a lost localisation.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/processes/shell.hpp"

namespace handsel::test::robot_drives_test {
namespace {

using Json = nlohmann::json;

Json trial_of(const std::string& scenario, const Outcome& outcome) {
  std::istringstream lines(outcome.out);
  std::string line;
  if (!std::getline(lines, line)) {
    ADD_FAILURE() << scenario << ": " << outcome.err;
    return {};
  }
  return Json::parse(line);
}

Json replay(const std::string& scenario, int seed) {
  return trial_of(scenario, shell(std::string(HANDSEL_COMMAND) + " eval --scenario " + scenario +
                                  " --replay " + std::to_string(seed)));
}

TEST(Driving, past_a_person_without_coming_too_near) {
  const Json trial = replay("drive_past", 2);
  EXPECT_TRUE(trial["success"].get<bool>()) << trial["reason"];
  EXPECT_EQ(trial["ssm_violations"].get<int>(), 0);
  EXPECT_EQ(trial["collisions"].get<int>(), 0);
  EXPECT_EQ(trial["limit_violations"].get<int>(), 0);
  EXPECT_GT(trial["min_separation_m"].get<double>(), 0.2);
}

TEST(Driving, a_mug_is_fetched_from_a_sideboard_and_given_to_a_person_elsewhere) {
  const Json trial = replay("fetch_mug", 3);
  EXPECT_TRUE(trial["success"].get<bool>()) << trial["reason"];
  EXPECT_EQ(trial["ssm_violations"].get<int>(), 0);
  EXPECT_EQ(trial["collisions"].get<int>(), 0);
  EXPECT_EQ(trial["drops"].get<int>(), 0);
}

TEST(Driving, a_slip_of_the_wheels_is_seen_and_the_drive_planned_again) {
  const Json trial = replay("drive_with_slip", 1);
  EXPECT_TRUE(trial["success"].get<bool>()) << trial["reason"];
  EXPECT_EQ(trial["collisions"].get<int>(), 0);
  EXPECT_NE(trial["tasks"].dump().find("the wheels slipped or the localisation jumped"),
            std::string::npos)
      << trial["tasks"];
}

TEST(Driving, a_lost_localisation_stops_the_robot_until_it_is_found) {
  const Outcome outcome =
      shell(std::string(HANDSEL_COMMAND) + " eval --scenario drive_unlocalised --replay 1");
  const Json trial = trial_of("drive_unlocalised", outcome);
  EXPECT_TRUE(trial["success"].get<bool>()) << trial["reason"];
  EXPECT_NE(outcome.err.find("(unlocalised)"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace handsel::test::robot_drives_test
