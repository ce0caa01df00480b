// SPDX-License-Identifier: Apache-2.0
// Rise of the speed factor after people have slowed the arm.
#include "components/trajectory_controller/supervise/speed_rise.hpp"

#include <gtest/gtest.h>

namespace handsel::trajectory_controller::speed_rise_test {
namespace {

constexpr SpeedRiseSettings kSettings{
    .period = 0.01, .rate = 2.0, .unproven_ratio = 0.8, .unproven_rate = 0.2};

TEST(SpeedRise, falls_at_once_and_rises_at_its_rate) {
  SpeedRise rise(kSettings);
  EXPECT_EQ(rise.next({1.0}).factor, 1.0);
  EXPECT_EQ(rise.next({0.3}).factor, 0.3);
  EXPECT_NEAR(rise.next({1.0}).factor, 0.32, 1e-12);
  EXPECT_NEAR(rise.next({0.33}).factor, 0.33, 1e-12) << "no more than the limit";
  for (int k = 0; k < 34; ++k) rise.next({1.0}).factor;
  EXPECT_NEAR(rise.next({1.0}).factor, 1.0, 1e-12);
}

TEST(SpeedRise, begins_at_zero_once_forbidden_and_at_one_from_rest) {
  SpeedRise rise(kSettings);
  rise.forbid();
  EXPECT_NEAR(rise.next({1.0}).factor, 0.02, 1e-12);
  rise.rest();
  EXPECT_EQ(rise.next({1.0}).factor, 1.0);
}

TEST(SpeedRise, after_an_unproven_set_point_stays_below_the_factor_of_then) {
  SpeedRise rise(kSettings);
  rise.lower(0.5);
  EXPECT_NEAR(rise.next({1.0}).factor, 0.402, 1e-12);
  rise.rest();
  EXPECT_NEAR(rise.next({1.0}).factor, 0.404, 1e-12) << "the stop itself changes nothing";
  for (int k = 0; k < 100; ++k) rise.next({1.0}).factor;
  EXPECT_NEAR(rise.next({1.0}).factor, 0.606, 1e-9);
  rise.restart();
  EXPECT_EQ(rise.next({1.0}).factor, 1.0) << "another path";
}

TEST(SpeedRise, what_lowered_the_factor_is_the_cause_while_it_rises) {
  SpeedRise rise(kSettings);
  rise.next({0.3, false, true});
  EXPECT_TRUE(rise.next({1.0}).wall);
  EXPECT_FALSE(rise.next({1.0}).people);
  for (int k = 0; k < 50; ++k) rise.next({1.0});
  EXPECT_FALSE(rise.next({1.0}).wall);
}

}  // namespace
}  // namespace handsel::trajectory_controller::speed_rise_test
