// SPDX-License-Identifier: Apache-2.0
// A robot with two arms brings objects to places out of reach of one arm: in lock-step, with the
// goals of the shipped scenarios.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/support/processes/shell.hpp"

namespace handsel::test::between_hands_test {
namespace {

using Json = nlohmann::json;

TEST(BetweenHands, objects_come_to_the_goals_that_one_arm_does_not_reach) {
  const std::string command =
      std::string(HANDSEL_COMMAND) +
      " eval --scenario duo_regrasp_1 duo_regrasp_2 --trials 1 --seed 2 --jobs 2";
  const Outcome outcome = shell(command);
  std::istringstream lines(outcome.out);
  std::set<std::string> scenarios;
  for (std::string line; std::getline(lines, line);) {
    const Json trial = Json::parse(line);
    scenarios.insert(trial["scenario"]);
    EXPECT_TRUE(trial["success"].get<bool>()) << trial["scenario"] << ": " << outcome.err;
    EXPECT_EQ(trial["drops"].get<int>(), 0);
  }
  EXPECT_EQ(scenarios.size(), 2u) << outcome.err;
}

}  // namespace
}  // namespace handsel::test::between_hands_test
