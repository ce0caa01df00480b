// Pushes on the arm, moving and at rest.
#include "components/trajectory_controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller {
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
    b.external_torque[1] = 20.0 * std::min(1.0, k * 0.002);  // a load taken up
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
  ASSERT_EQ(b.go_to(goal(), 1), "");
  b.run(6);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
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

}  // namespace
}  // namespace handsel::trajectory_controller
