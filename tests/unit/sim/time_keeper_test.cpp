// SPDX-License-Identifier: Apache-2.0
#include "sim/time_keeper.hpp"

#include <gtest/gtest.h>

#include <random>

using namespace handsel;
using namespace handsel::sim;

namespace {

TimePoint at(double seconds) { return TimePoint(from_seconds(seconds)); }

SimSettings settings() {
  SimSettings s;
  s.robot_side.period = 0.001;
  return s;
}

/// Makes the steps that may be made now; returns their number.
int turn(TimeKeeper& keeper, double wall, bool set_points) {
  keeper.turn(at(wall));
  int steps = 0;
  for (; keeper.may_step(set_points); ++steps) keeper.stepped();
  return steps;
}

TEST(TimeKeeper, keeps_the_pace_of_the_machine_when_nobody_is_late) {
  TimeKeeper keeper(settings());
  int steps = 0;
  for (int i = 0; i <= 1000; ++i) {
    keeper.answered("spark", 1, keeper.grant_number());
    steps += turn(keeper, 5 + 0.001 * i, true);
  }
  EXPECT_EQ(steps, 1001);
  EXPECT_EQ(keeper.waited(), Duration::zero());
}

TEST(TimeKeeper, waits_for_a_set_point_only_as_long_as_they_come) {
  TimeKeeper keeper(settings());
  EXPECT_EQ(turn(keeper, 5, false), 1) << "none has ever come";
  EXPECT_EQ(turn(keeper, 5.001, true), 1);
  double wall = 5.002;
  int steps = 0;
  for (; wall < 5.4; wall += 0.001) steps += turn(keeper, wall, false);
  EXPECT_EQ(steps, 0);
  for (; wall < 5.6; wall += 0.001) steps += turn(keeper, wall, false);
  EXPECT_GT(steps, 50) << "no longer than max_wait";
  EXPECT_NEAR(to_seconds(keeper.waited()), 0.5, 0.02);
}

TEST(TimeKeeper, time_stands_still_until_everybody_has_answered) {
  TimeKeeper keeper(settings());
  keeper.answered("spark", 1, 0);
  int steps = 0;
  double wall = 5;
  for (; wall < 5.2; wall += 0.001) steps += turn(keeper, wall, true);
  EXPECT_EQ(steps, 10) << "one clock_period";
  EXPECT_EQ(keeper.grant().until, at(5) + from_seconds(0.02));
  keeper.answered("spark", 1, 1);
  steps += turn(keeper, wall, true);
  EXPECT_GT(steps, 10);
  EXPECT_EQ(keeper.grant_number(), 2u);
  EXPECT_NEAR(to_seconds(keeper.waited()), 0.185, 0.002);
}

TEST(TimeKeeper, one_that_does_not_answer_holds_the_others_up_once) {
  TimeKeeper keeper(settings());
  keeper.answered("spark", 1, 0);
  int steps = 0;
  for (double wall = 5; wall < 7; wall += 0.001) steps += turn(keeper, wall, true);
  EXPECT_NEAR(steps, 1500, 20);
  keeper.answered("spark", 2, keeper.grant_number());  // restarted: awaited again
  const std::uint64_t grant = keeper.grant_number();
  for (double wall = 7; wall < 7.3; wall += 0.001) turn(keeper, wall, true);
  EXPECT_EQ(keeper.grant_number(), grant + 1);
}

TEST(TimeKeeper, a_stopped_process_is_not_waited_for) {
  TimeKeeper keeper(settings());
  keeper.answered("spark", 7, 0);
  int steps = 0;
  for (double wall = 5; wall < 6; wall += 0.001) {
    keeper.leave_out_stopped([](std::uint64_t process) { return process != 7; });
    steps += turn(keeper, wall, true);
  }
  EXPECT_GT(steps, 930) << "it is held up for 50 ms, once";
}

TEST(TimeKeeper, a_starved_simulator_neither_rushes_nor_gives_up_on_others) {
  TimeKeeper keeper(settings());
  keeper.answered("spark", 1, 0);
  turn(keeper, 5, true);
  EXPECT_LE(turn(keeper, 6, true), 6)
      << "steps that are late by more than max_lag are not made up for";
  for (double wall = 6; wall < 10; wall += 1) turn(keeper, wall, true);  // one turn per second
  keeper.answered("spark", 1, keeper.grant_number());
  EXPECT_NEAR(to_seconds(at(10) - keeper.time()), to_seconds(keeper.waited()), 2)
      << "the time of a step is wall less waited";
}

TEST(TimeKeeper, nobodys_time_is_ever_more_than_two_periods_ahead_of_a_step) {
  std::mt19937 random(4711);
  std::uniform_real_distribution<double> wait(0, 0.03);
  TimeKeeper keeper(settings());
  double wall = 5;
  for (int i = 0; i < 20000; ++i) {
    wall += wait(random);
    if (random() % 3 == 0) keeper.answered("spark", 1, keeper.grant_number());
    turn(keeper, wall, random() % 4 != 0);
    ASSERT_LE(to_seconds(keeper.grant().until - keeper.time()), 0.02 + 1e-9);
    ASSERT_GE(to_seconds(keeper.grant().until - keeper.time()), 0.01 - 1e-9);
  }
}

}  // namespace
