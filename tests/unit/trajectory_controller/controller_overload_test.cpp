// SPDX-License-Identifier: Apache-2.0
// Controller and robot side together, with a gap in the set-points: the robot side stops by itself,
// and both continue in order.
#include <gtest/gtest.h>

#include <random>

#include "common/robot_side/robot_side.hpp"
#include "tests/support/controller_expectations.hpp"

namespace handsel::trajectory_controller::controller_overload_test {
namespace {

using test::ControllerBench;
using test::goal;
using test::has;

/// Closed loop: the set-points reach the robot side, whose motion is the measurement of the
/// controller.
struct Loop {
  ControllerBench bench;
  RobotSide side;
  bool wire_holds{true};
  bool reports_reference{true};
  Vector bend;      // measured configuration minus reference, all axes
  double shaken{};  // motion of the fingers by a person who holds the object between them [rad]
  std::uint64_t sent{};

  explicit Loop(const RobotSideSettings& settings = {})
      : side(*bench.robot, Vector::Zero(bench.robot->dof()), settings),
        bend(Vector::Zero(bench.robot->dof())) {
    bench.follows = false;
  }
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / bench.settings.period + 0.5); ++k) {
      const bool ready = bench.tick();
      const double now = to_seconds(bench.now.time_since_epoch());
      sent += ready ? 1 : 0;
      if (ready && wire_holds) {
        JointCommand c;
        c.sequence = sent;
        c.position = bench.core.set_point().position;
        c.velocity = bench.core.set_point().velocity;
        c.acceleration = bench.core.set_point().acceleration;
        side.command(c, now);
      }
      side.step(now, bench.settings.period);
      constexpr double kRate = 2 * M_PI * 2.0;  // [rad/s]
      bench.measured = side.position() + bend;
      for (int axis = 3; axis < 5; ++axis) {
        bench.measured[axis] += shaken * std::sin(kRate * now);
        bench.measured_velocity[axis] = shaken * kRate * std::cos(kRate * now);
      }
      side.measured(bench.measured);
      bench.drive = side.mode();
      bench.refusal = side.refusal();
      if (reports_reference) side.report(bench.reference);
    }
  }
  /// Returns the max motion of an axis of the arm within this time [rad].
  double creeps(double seconds) {
    const Vector begin = bench.measured.head(3);
    double most = 0.0;
    for (double passed = 0.0; passed < seconds; passed += 0.05) {
      run(0.05);
      most = std::max(most, (bench.measured.head(3) - begin).cwiseAbs().maxCoeff());
    }
    return most;
  }
  std::string close_hand(std::uint64_t id) {
    HandCommand c;
    c.robot = "small";
    c.id = id;
    c.epoch = bench.go.epoch;
    c.position = Vector::Constant(2, id % 2 ? 1.2 : 0.1);
    return bench.core.accept(c, Duration(0), bench.now);
  }
};

TEST(Overload, the_robot_stands_by_itself_and_goes_on_with_a_new_go) {
  Loop l;
  l.run(0.3);
  ASSERT_EQ(l.bench.go_to(goal(), 1), "");
  l.run(0.8);
  ASSERT_FALSE(l.bench.at_rest());
  l.wire_holds = false;
  l.run(0.04);
  EXPECT_FALSE(l.side.follows());
  EXPECT_EQ(l.side.mode(), DriveMode::enabled) << "nobody has stopped the drives";
  EXPECT_NE(l.side.refusal().find("no set-point for"), std::string::npos) << l.side.refusal();
  EXPECT_EQ(l.bench.core.mode(), Mode::stop);
  EXPECT_TRUE(has(l.bench, Cause::cycle_late));
  EXPECT_FALSE(has(l.bench, Cause::drive_not_enabled)) << "what waits for a person";
  EXPECT_NE(l.bench.core.status().reason.find("no set-point for"), std::string::npos)
      << l.bench.core.status().reason;
  l.wire_holds = true;
  l.run(3.0);
  EXPECT_TRUE(l.side.follows());
  EXPECT_EQ(l.bench.core.mode(), Mode::hold);
  EXPECT_EQ(l.bench.core.status().causes, bit(Cause::no_go));
  ++l.bench.go.epoch;
  l.run(0.3);
  EXPECT_EQ(l.bench.core.mode(), Mode::normal);
  ASSERT_EQ(l.bench.go_to(goal(), 2), "");
  l.run(6.0);
  EXPECT_TRUE(l.side.position().head(3).isApprox(goal(), 1e-6)) << l.side.position().transpose();
  test::expect_smooth(l.bench);
}

/// Arm, head and hand each in the middle of a motion, and a hand bent by its held object.
// Set-points that follow the sagging arm would let it creep by the sag ten times per second.
TEST(Overload, a_sagging_arm_that_has_stopped_without_saying_so_stays_where_it_is) {
  for (const bool known : {true, false}) {
    SCOPED_TRACE(known ? "reference known" : "reference unknown");
    Loop l;
    l.reports_reference = known;
    l.bend.head(3) = Vector3(0.004, -0.003, 0.003);
    l.run(0.3);
    ASSERT_EQ(l.bench.go_to(goal(), 1), "");
    l.run(0.4);
    l.side.stop(DriveMode::enabled);
    for (int i = 0; i < 100 && l.bench.core.mode() != Mode::fault; ++i) l.run(0.05);
    ASSERT_EQ(l.bench.core.mode(), Mode::fault);
    // Delayed set-points at the configuration of the robot cause no motion, observed or not.
    for (const double seen : {0.1, 0.2, 0.4, 0.6}) {
      l.run(seen);
      l.bench.people.views.clear();
      EXPECT_LT(l.creeps(1.0), known ? 1e-9 : 0.005);
      l.bench.people.views = {test::live_view()};
    }
    EXPECT_LT(l.creeps(4.0), known ? 1e-9 : 0.005) << "at most once by its sag";
    l.run(1.0);
    EXPECT_LT(l.creeps(4.0), 1e-9);
    ++l.bench.go.epoch;
    l.bench.go.acknowledge = true;
    l.run(0.5);
    EXPECT_EQ(l.bench.core.mode(), Mode::normal) << l.bench.core.status().reason;
    ASSERT_EQ(l.bench.go_to(goal(), 2), "");
    l.run(6.0);
    EXPECT_TRUE(l.side.position().head(3).isApprox(goal(), 1e-6)) << l.side.position().transpose();
    test::expect_smooth(l.bench);
  }
}

TEST(Overload, a_sagging_arm_stays_where_it_is_though_its_state_was_late_for_a_while) {
  Loop l;
  l.bend.head(3) = Vector3(0.004, -0.003, 0.003);
  l.run(0.3);
  ASSERT_EQ(l.bench.go_to(goal(), 1), "");
  l.run(0.4);
  l.side.stop(DriveMode::enabled);
  for (int i = 0; i < 100 && l.bench.core.mode() != Mode::fault; ++i) l.run(0.05);
  ASSERT_EQ(l.bench.core.mode(), Mode::fault);
  l.run(2.0);
  for (int gap = 0; gap < 4; ++gap) {
    l.bench.robot_speaks = false;
    l.run(3 * l.bench.settings.timeouts.robot_state);
    l.bench.robot_speaks = true;
    EXPECT_LT(l.creeps(1.0), 1e-9) << "gap " << gap;
  }
}

TEST(Overload, a_sagging_arm_that_follows_under_a_fault_moves_at_most_once_by_its_sag) {
  for (const double sag : {0.004, 0.03}) {
    Loop l;
    l.run(0.3);
    ASSERT_EQ(l.bench.go_to(goal(), 1), "");
    l.run(0.8);
    l.bend[0] = -0.4;  // something holds the arm
    for (int i = 0; i < 100 && l.bench.core.mode() != Mode::fault; ++i) l.run(0.05);
    ASSERT_EQ(l.bench.core.mode(), Mode::fault);
    l.bend[0] = -sag;  // and releases the arm
    l.run(1.0);
    EXPECT_LT(l.creeps(4.0), 1.1 * sag) << "sag " << sag;
    l.run(1.0);
    EXPECT_LT(l.creeps(4.0), 1e-9) << "sag " << sag;
  }
}

TEST(Overload, a_controller_that_is_started_anew_keeps_the_grip_and_allows_for_the_load) {
  ControllerBench bench;
  const int n = bench.robot->dof();
  bench.reference = {Vector::Constant(n, 0.2), Vector::Zero(n), 0.35, {}};
  bench.reference.effort[3] = 0.4;
  bench.reference.effort[4] = -0.1;
  bench.measured = bench.reference.position;
  bench.measured[0] -= 0.003;  // the arm sags
  bench.run(0.5);
  EXPECT_EQ(bench.core.set_point().position, bench.reference.position);
  EXPECT_EQ(bench.core.hands().effort(), bench.reference.effort);
  EXPECT_EQ(bench.core.hands().payload(), 0.35);
}

TEST(Overload, an_arm_that_a_fault_finds_pressed_against_something_no_longer_presses) {
  Loop l;
  l.run(0.3);
  ASSERT_EQ(l.bench.go_to(goal(), 1), "");
  l.run(0.8);
  l.bend[0] = -0.4;  // an obstacle holds the arm while its reference is followed
  for (int i = 0; i < 100 && l.bench.core.mode() != Mode::fault; ++i) l.run(0.05);
  ASSERT_EQ(l.bench.core.mode(), Mode::fault);
  const double pressed_at = l.bench.measured[0];
  for (int i = 0; i < 80; ++i) {
    l.bend[0] = pressed_at - l.side.position()[0];
    l.run(0.05);
  }
  EXPECT_NEAR(l.side.position()[0], pressed_at, 0.01);
}

TEST(Overload, whatever_moved_when_set_points_stayed_away_the_robot_side_follows_again) {
  std::mt19937_64 random(5);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  for (int trial = 0; trial < 60; ++trial) {
    Loop l;
    l.run(0.3);
    if (trial % 2 == 0) {
      ASSERT_EQ(l.bench.go_to(goal(), 1), "");
    }
    if (trial % 3 != 0) {
      l.bench.advice.has_gaze_target = true;
      l.bench.advice.gaze_target = Vector3(between(-1, 1), between(-1, 1), 1.0);
    }
    if (trial % 5 != 0) {
      ASSERT_EQ(l.close_hand(1), "");
    }
    l.run(between(0.05, 0.8));
    l.bend[3] = between(-0.05, 0.05);
    l.wire_holds = false;
    l.run(between(0.022, 0.3));
    l.wire_holds = true;
    ASSERT_FALSE(l.side.follows()) << trial;
    l.run(3.0);
    EXPECT_TRUE(l.side.follows()) << "trial " << trial << ": " << l.side.refusal() << "\nset-point "
                                  << l.bench.core.set_point().position.transpose() << "\nreference "
                                  << l.side.position().transpose();
    ++l.bench.go.epoch;
    l.run(2.5);
    EXPECT_NE(l.bench.core.status().hand, HandState::moving)
        << trial << ": whoever waits for the hand would wait for ever";
    EXPECT_LT(l.bench.core.mode(), Mode::hold) << trial << ": " << l.bench.core.status().reason;
    EXPECT_EQ(l.close_hand(2), "") << trial;
    test::expect_smooth(l.bench);
  }
}

/// A person who holds the object moves the fingers continuously, in any phase of a grasp or
/// release.
TEST(Overload, a_closed_hand_that_a_person_shakes_follows_again) {
  std::mt19937_64 random(7);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  for (int trial = 0; trial < 40; ++trial) {
    Loop l(RobotSideSettings{.period = 0.001});
    l.run(0.3);
    ASSERT_EQ(l.close_hand(1), "");
    l.run(between(0.05, 2.0));
    l.bend[3] = between(-0.05, 0.05);
    l.bend[4] = between(-0.05, 0.05);
    l.shaken = 0.04;
    l.wire_holds = false;
    l.run(between(0.022, 0.3));
    l.wire_holds = true;
    ASSERT_FALSE(l.side.follows()) << trial;
    l.run(2.0);
    EXPECT_TRUE(l.side.follows()) << "trial " << trial << ": " << l.side.refusal() << "\nset-point "
                                  << l.bench.core.set_point().position.transpose() << "\nreference "
                                  << l.side.position().transpose();
    ++l.bench.go.epoch;
    l.run(2.5);
    EXPECT_LT(l.bench.core.mode(), Mode::hold) << trial << ": " << l.bench.core.status().reason;
    EXPECT_EQ(l.side.refused(), 0u) << l.side.refusal();
    test::expect_smooth(l.bench);
  }
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_overload_test
