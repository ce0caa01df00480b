// SPDX-License-Identifier: Apache-2.0
// Pushes on the arm, moving and at rest.
#include "components/trajectory_controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_contact_test {
namespace {

using test::ControllerBench;
using test::expect_smooth;
using test::goal;
using test::has;
using testing::HasSubstr;

TEST(Controller, a_push_on_the_moving_arm_stops_it_and_a_load_does_not) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.2, 0.4, -0.5), 1), "");
  b.run(1.0);
  for (int k = 0; k < 500; ++k) {
    b.external_torque[1] = 20.0 * std::min(1.0, k * 0.002);  // load of a grasped object
    b.tick();
  }
  EXPECT_EQ(b.core.mode(), Mode::normal);
  b.external_torque[1] += 35.0;
  b.run(0.04);
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_THAT(b.core.status().reason, HasSubstr("contact: felt by shoulder"));
  EXPECT_TRUE(has(b, Cause::contact));
  EXPECT_FALSE(has(b, Cause::separation));
  b.external_torque[1] -= 35.0;
  b.run(1.0);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.mode(), Mode::hold);
}

TEST(Controller, a_push_at_rest_moves_the_arm_along_and_its_end_stops_it) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  b.external_torque[0] = 25.0;
  b.run(0.8);
  const double pushed = b.core.set_point().position[0];
  EXPECT_GT(pushed, 0.03);
  EXPECT_LT(b.core.mode(), Mode::stop);
  EXPECT_EQ(b.core.set_point().position[1], 0.0) << "only the axis that is pushed";
  b.external_torque[0] = 0.0;
  b.run(0.6);
  EXPECT_TRUE(b.at_rest());
  const double rested = b.core.set_point().position[0];
  b.external_torque[0] = -40.0;
  b.run(0.8);
  EXPECT_LT(b.core.set_point().position[0], rested - 0.03);
  b.run(2.0);
  EXPECT_GE(b.core.set_point().position[0], rested - b.settings.yield_reach - 1e-9);
  b.run(3.0);
  EXPECT_TRUE(b.at_rest()) << "a push without end is a load";
  expect_smooth(b);
  b.external_torque[0] = 0.0;
  b.run(5.0);
  ++b.go.epoch;  // the contact became a clamp
  b.run(0.2);
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished) << b.core.status().reason;
}

TEST(Controller, after_a_contact_the_arm_gives_way_to_who_is_pressed) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0, 0), 1), "");
  b.run(1.5);
  b.external_torque[0] = -40.0;
  b.run(0.8);
  EXPECT_GE(b.core.mode(), Mode::hold);
  const double stopped = b.core.set_point().position[0];
  b.run(0.5);
  EXPECT_LT(b.core.set_point().position[0], stopped - 0.03);
  b.external_torque[0] = 0.0;
  b.run(1.5);
  EXPECT_TRUE(b.at_rest());
  const double left = b.core.set_point().position[0];
  b.run(1.0);
  EXPECT_EQ(b.core.set_point().position[0], left) << "nor does it come after them";
  expect_smooth(b);
}

TEST(Controller, a_clamp_stays_a_stop_until_it_is_freed_and_the_arm_gives_way_as_far_as_it_may) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0, 0), 1), "");
  b.run(1.5);
  b.external_torque[0] = -40.0;
  b.run(2.5);
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_TRUE(has(b, Cause::clamped));
  EXPECT_THAT(b.core.status().reason, HasSubstr("clamped: felt by"));
  b.run(20.0);
  EXPECT_TRUE(has(b, Cause::clamped)) << "a steady push never becomes usual";
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_TRUE(b.at_rest());
  b.external_torque[0] = 0.0;
  b.run(1.0);
  EXPECT_EQ(b.core.mode(), Mode::hold);
  ++b.go.epoch;
  b.run(0.5);
  EXPECT_EQ(b.core.mode(), Mode::normal);
  expect_smooth(b);
}

TEST(Controller, an_arm_pressed_ever_harder_gives_way_once_it_is_clamped) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  while (b.external_torque[0] > -45.0) {
    b.external_torque[0] -= 0.04;
    b.run(0.01);
  }
  b.run(1.5);
  ASSERT_TRUE(has(b, Cause::clamped));
  EXPECT_LT(b.core.set_point().position[0], -0.05)
      << "no push is felt beyond one that grew so slowly";
  b.external_torque[0] = 0.0;
  b.run(1.5);
  const double left = b.core.set_point().position[0];
  EXPECT_TRUE(b.at_rest());
  b.run(1.0);
  EXPECT_EQ(b.core.set_point().position[0], left)
      << "nor does the end of the press count as a push";
  expect_smooth(b);
}

TEST(Controller, an_arm_that_gives_way_rests_first_when_the_permission_ends) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.start();
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.5, 0, 0), 1), "");
  b.run(1.5);
  b.external_torque[0] = -40.0;
  b.run(1.3);
  ASSERT_FALSE(b.at_rest()) << "the arm gives way";
  b.go.allowed = false;
  ++b.go.epoch;
  bool rested = false;
  for (int i = 0; i < 700 && !rested; ++i) {
    b.tick();
    rested = rested || b.at_rest();
  }
  EXPECT_TRUE(rested) << "a pause is answered by rest, though somebody presses";
  b.run(0.2);
  EXPECT_FALSE(b.at_rest()) << "a push that lasts then moves the arm again";
  expect_smooth(b);
}

/// The hand has closed on something; anna, whose hand is at it, is being exchanged with.
void close_for_an_exchange(ControllerBench& b) {
  b.external_torque = Vector::Zero(7);
  b.people.people.push_back(b.standing(0.9, 0.0));
  b.start();
  ActionStatus action;
  action.exchange_engaged = true;
  action.human = "anna";
  b.core.on(action, b.now);
  HandCommand c;
  c.robot = "small";
  c.id = 1;
  c.epoch = 1;
  c.action = HandAction::grasp;
  c.position = Vector::Constant(2, 0.6);
  b.external_torque.segment(3, 2).setConstant(-0.5);  // an object between the fingers
  ASSERT_EQ(b.core.accept(c, Duration(0), b.now), "");
  for (int k = 0; k < 5000 && (k == 0 || b.core.status().hand == HandState::moving); ++k) b.tick();
  ASSERT_EQ(b.core.status().hand, HandState::grasped);
  b.run(0.1);
}

TEST(Controller, a_pull_in_an_exchange_is_wanted_and_a_clamp_opens_the_hand) {
  ControllerBench b;
  close_for_an_exchange(b);
  b.external_torque[0] = 40.0;
  b.run(3.0);
  EXPECT_FALSE(has(b, Cause::clamped));
  EXPECT_EQ(b.core.status().hand, HandState::grasped);
  b.external_torque[0] = 60.0;
  b.run(0.8);
  EXPECT_EQ(b.core.status().hand, HandState::grasped);
  b.run(2.0);
  EXPECT_TRUE(has(b, Cause::clamped));
  EXPECT_EQ(b.core.mode(), Mode::stop);
  EXPECT_EQ(b.core.status().hand, HandState::released);
  EXPECT_NEAR(b.core.set_point().position[3], 0.0, 1e-3) << "open as before it closed";
  expect_smooth(b);
}

TEST(Controller, in_an_exchange_too_a_contact_beyond_its_budget_stops_the_moving_arm) {
  ControllerBench b;
  b.external_torque = Vector::Zero(7);
  b.people.people.push_back(b.standing(3.0, 0.0));
  b.start();
  ActionStatus action;
  action.exchange_engaged = true;
  action.human = "anna";
  b.core.on(action, b.now);
  ASSERT_EQ(b.go_to(ControllerBench::arm(1.2, 0.0, 0.0), 2), "");
  b.run(0.8);
  ASSERT_FALSE(b.at_rest());
  b.external_torque[0] = 60.0;
  b.run(0.05);
  EXPECT_TRUE(has(b, Cause::contact));
  EXPECT_EQ(b.core.mode(), Mode::stop);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_contact_test
