// SPDX-License-Identifier: Apache-2.0
// A person who walks up to the robot without avoiding it: the walk, and the refusal of invalid
// walks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "common/base/errors.hpp"
#include "sim/people/person_settings.hpp"
#include "sim/people/step_in.hpp"
#include "sim/scene/scene_setup.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::step_in_test {
namespace {

constexpr double kAcceleration = PersonManners{}.person_max_step_acceleration;

TEST(StepIn, walks_in_at_the_speed_stays_and_walks_back) {
  const StepInSettings visit{3.0, 1.6, 2.0};
  constexpr double kFrom = 1.5, kStep = 0.001;
  EXPECT_EQ(distance_from_place(visit, kFrom, 0.0, kAcceleration), kFrom);
  EXPECT_EQ(distance_from_place(visit, kFrom, 3.0, kAcceleration), kFrom);
  double fastest = 0, stayed = 0, before = kFrom;
  for (double time = 3.0; time < 9.0; time += kStep) {
    const double distance = distance_from_place(visit, kFrom, time, kAcceleration);
    fastest = std::max(fastest, std::abs(distance - before) / kStep);
    stayed += distance < 1e-9 ? kStep : 0.0;
    ASSERT_GE(distance, 0.0);
    ASSERT_LE(distance, kFrom);
    before = distance;
  }
  EXPECT_NEAR(fastest, 1.6, 0.01);
  EXPECT_NEAR(stayed, 2.0, 0.1);
  EXPECT_EQ(distance_from_place(visit, kFrom, 9.0, kAcceleration), kFrom);
}

TEST(StepIn, over_a_short_way_the_speed_is_not_reached) {
  const StepInSettings visit{0.0, 1.6, 1.0};
  double fastest = 0;
  for (double time = 0; time < 1.0; time += 0.001)
    fastest = std::max(fastest, (distance_from_place(visit, 0.3, time, kAcceleration) -
                                 distance_from_place(visit, 0.3, time + 0.001, kAcceleration)) /
                                    0.001);
  EXPECT_LT(fastest, 1.2);
  EXPECT_GT(fastest, 0.9);
}

using handsel::test::message_of;

SceneSetup set_up_with(config::PersonDescription person, std::uint64_t seed) {
  config::Scenario scenario;
  person.set_id("ben");
  *scenario.add_people() = person;
  return set_up(scenario, test::jido(), test::library(), 4, {}, seed);
}

config::PersonDescription visitor() {
  config::PersonDescription person;
  person.set_behaviour(config::STILL);
  person.set_approach_from(1.5);
  person.mutable_steps_in()->set_speed(1.6);
  person.mutable_steps_in()->set_earliest(4);
  person.mutable_steps_in()->set_latest(25);
  return person;
}

TEST(StepIn, begins_at_a_time_that_the_seed_draws) {
  std::set<double> times;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double at = set_up_with(visitor(), seed).people.at(0).settings.steps_in.at;
    EXPECT_GE(at, 4);
    EXPECT_LE(at, 25);
    times.insert(at);
  }
  EXPECT_EQ(times.size(), 20u);
}

TEST(StepIn, what_cannot_be_is_refused) {
  const auto refusal = [](const config::PersonDescription& person) {
    return message_of<ConfigError>([&] { set_up_with(person, 1); });
  };
  config::PersonDescription person = visitor();
  person.set_behaviour(config::TAKER);
  EXPECT_THAT(refusal(person), testing::HasSubstr("ben steps in but is not STILL"));
  person = visitor();
  person.set_approach_from(0);
  EXPECT_THAT(refusal(person), testing::HasSubstr("approach_from is not above 0"));
  person = visitor();
  person.mutable_steps_in()->set_speed(0);
  EXPECT_THAT(refusal(person), testing::HasSubstr("speed must be above 0"));
  person = visitor();
  person.mutable_steps_in()->set_latest(1);
  EXPECT_THAT(refusal(person), testing::HasSubstr("latest must not be below earliest"));
}

}  // namespace
}  // namespace handsel::sim::step_in_test
