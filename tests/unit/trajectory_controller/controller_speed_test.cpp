// SPDX-License-Identifier: Apache-2.0
// Speed of the arm, its causes, and the reports of both.
#include "components/trajectory_controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_speed_test {
namespace {

using test::ControllerBench;
using test::expect_smooth;
using test::has;
using testing::HasSubstr;

TEST(Controller, a_costly_way_ahead_is_taken_slower_but_not_at_an_exchange) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0.5, -0.5), 4), "");
  b.forecast.trajectory = 4;
  b.forecast.cost = 0.75;
  b.run(0.8);
  EXPECT_EQ(b.core.mode(), Mode::slow);
  EXPECT_TRUE(has(b, Cause::cost_ahead));
  EXPECT_THAT(b.core.status().reason, HasSubstr("cost_ahead"));
  EXPECT_NEAR(b.core.speed_factor(), 0.7, 1e-6) << "half the way from cost_from to 1";
  double last = 1.0;
  for (double cost : {0.52, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    b.forecast.cost = cost;
    b.run(0.3);
    EXPECT_LE(b.core.speed_factor(), last + 1e-6) << cost;
    last = b.core.speed_factor();
  }
  EXPECT_NEAR(last, b.settings.cost_factor, 1e-6);
  b.forecast.trajectory = 3;
  b.run(0.8);
  EXPECT_NEAR(b.core.speed_factor(), 1.0, 1e-6) << "it speaks of another trajectory";
  EXPECT_FALSE(has(b, Cause::cost_ahead));
  b.forecast.trajectory = 4;
  ActionStatus exchange;
  exchange.exchange_engaged = true;
  exchange.human = "anna";
  b.core.on(exchange, b.now);
  b.run(0.3);
  EXPECT_NEAR(b.core.speed_factor(), 1.0, 1e-6);
  expect_smooth(b);
}

TEST(Controller, the_least_of_all_factors_holds_and_every_cause_is_named) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0.5, -0.5), 4), "");
  b.forecast.trajectory = 4;
  b.forecast.cost = 1.0;
  b.go.override_factor = 0.8;
  b.advice.speed_factor = 0.6;
  b.people.covered = false;
  b.run(1.0);
  EXPECT_NEAR(b.core.speed_factor(), b.settings.guard.uncovered_factor, 1e-6);
  const std::uint32_t all = bit(Cause::cost_ahead) | bit(Cause::override_slow) |
                            bit(Cause::attention_slow) | bit(Cause::human_unknown);
  EXPECT_EQ(b.core.status().causes, all);
}

TEST(Controller,
     a_trajectory_that_comes_while_somebody_runs_in_begins_with_no_more_than_the_guard_allows) {
  ControllerBench b;
  b.people.people = {b.standing(1.15, 0.0)};
  for (BodyJoint& j : b.people.people[0].joints) j.velocity = Vector3(-2.0, 0.0, 0.0);
  b.human_age = 0.05;
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.2, 0, 0), 1), "");
  EXPECT_EQ(b.core.speed_factor(), 0.0) << "before its first step";
  b.run(0.5);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.status().motion, MotionState::running) << "it waits";
  b.people.people.clear();
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

TEST(Controller, at_rest_it_draws_back_from_who_comes_too_near_as_far_as_it_may) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(test::goal(), 1), "");
  b.run(6);
  ASSERT_EQ(b.core.status().motion, MotionState::finished);
  const Vector stood = b.core.set_point().position;
  b.people.people = {b.standing(1.0, 0.5)};
  b.run(0.5);
  const double near = b.core.status().separation;
  EXPECT_TRUE(b.at_rest()) << "nobody asked for it";
  b.advice.speed_factor = -0.5;
  b.run(4.0);
  EXPECT_GT(b.core.status().separation, near + 0.03);
  const double moved = (b.core.set_point().position - stood).cwiseAbs().maxCoeff();
  EXPECT_GT(moved, 0.05);
  EXPECT_LE(moved, b.settings.retreat_reach + 1e-9);
  b.advice.speed_factor = 1.0;
  b.run(1.0);
  EXPECT_TRUE(b.at_rest());
  ASSERT_EQ(b.go_to(ControllerBench::arm(0, 0, 0), 2), "") << "and is ready for the next";
  expect_smooth(b);
}

TEST(Controller, it_retreats_beside_its_path_from_a_person_too_near_and_then_goes_on) {
  ControllerBench b;
  b.start();
  ASSERT_EQ(b.go_to(test::goal(), 1), "");
  b.run(1.2);
  b.people.people = {b.standing(1.0, 0.5)};
  b.run(0.1);
  b.advice.speed_factor = 0.0;
  b.advice.leaves_path = true;
  b.run(0.5);
  const double near = b.core.status().separation;
  b.run(3.0);
  EXPECT_GT(b.core.status().separation, near + 0.03);
  EXPECT_EQ(b.core.status().motion, MotionState::running) << "the path is not given up";
  EXPECT_TRUE(b.at_rest());
  b.people.people.clear();
  b.advice.speed_factor = 1.0;
  b.advice.leaves_path = false;
  b.run(8);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  expect_smooth(b);
}

TEST(Controller, the_causes_of_a_retreat_do_not_flicker) {
  ControllerBench b;
  b.start();
  b.people.people = {b.standing(1.0, 0.5)};
  b.advice.speed_factor = -0.5;
  int changes = 0;
  bool is_slowed = false;
  std::uint32_t causes = b.core.status().causes;
  for (int k = 0; k < 2000; ++k) {
    b.tick();
    const std::uint32_t now = b.core.status().causes;
    changes += now != causes;
    is_slowed = is_slowed || (now & bit(Cause::separation)) != 0;
    causes = now;
  }
  EXPECT_TRUE(is_slowed);
  EXPECT_LE(changes, 8);
}

TEST(Controller, it_does_not_draw_back_without_permission_nor_where_that_is_switched_off) {
  for (const bool allowed : {true, false}) {
    ControllerSettings s;
    if (allowed) s.retreat_reach = 0.0;
    ControllerBench b(s);
    b.start();
    ASSERT_EQ(b.go_to(test::goal(), 1), "");
    b.run(6);
    const Vector stood = b.core.set_point().position;
    b.people.people = {b.standing(1.0, 0.5)};
    b.advice.speed_factor = -1.0;
    b.go.allowed = allowed;
    b.run(3.0);
    EXPECT_EQ(b.core.set_point().position, stood);
  }
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_speed_test
