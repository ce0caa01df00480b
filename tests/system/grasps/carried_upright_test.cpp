// SPDX-License-Identifier: Apache-2.0
// A full mug is carried upright from the table into the hand of a person: in lock-step.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/processes/shell.hpp"

namespace handsel::test::carried_upright_test {
namespace {

using Json = nlohmann::json;

constexpr double kMaxTilt = 0.35;  // max tilt, of deploy/objects/full_mug [rad]
constexpr int kTrials = 3;

TEST(CarriedUpright, a_full_mug_leans_over_no_farther_than_its_description_allows) {
  const Outcome outcome =
      shell(std::string(HANDSEL_COMMAND) + " eval --scenario give_full_mug --trials " +
            std::to_string(kTrials) + " --seed 1 --jobs 2");
  std::istringstream lines(outcome.out);
  int trials = 0;
  for (std::string line; std::getline(lines, line); ++trials) {
    const Json trial = Json::parse(line);
    EXPECT_TRUE(trial["success"].get<bool>()) << trial["reason"];
    ASSERT_FALSE(trial["max_tilt_rad"].is_null()) << trial["reason"];
    EXPECT_LE(trial["max_tilt_rad"].get<double>(), kMaxTilt) << "seed " << trial["seed"];
  }
  EXPECT_EQ(trials, kTrials) << outcome.err;
}

}  // namespace
}  // namespace handsel::test::carried_upright_test
