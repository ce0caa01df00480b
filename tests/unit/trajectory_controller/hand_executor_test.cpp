// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/hand/hand_executor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "common/trajectory/edit.hpp"

namespace handsel::trajectory_controller::hand_executor_test {
namespace {

constexpr double kDt = 0.001;
constexpr double kStiffness = 40.0;  // stiffness of the fingers [Nm/rad]

KinematicLimits limits(int n, double v, double a, double j) {
  return {Eigen::VectorXd::Constant(n, v), Eigen::VectorXd::Constant(n, a),
          Eigen::VectorXd::Constant(n, j)};
}

/// A hand of four axes whose servos follow the set-point as springs, pushed by the effort given
/// besides, until something blocks them.
class HandTest : public testing::Test {
 protected:
  HandTest()
      : hand_(HandSettings{}, {{0, 1, 2, 3}, {-0.2, -0.2, -0.2, -0.2}, {1.4, 1.4, 1.4, 1.4}, {}},
              limits(4, 2.5, 12, 90), limits(4, 2.8, 14, 100)) {
    out_ = rest_state(Vector::Zero(4));
    robot_.position = robot_.velocity = robot_.effort = Vector::Zero(4);
    block_.assign(4, 10.0);
    hand_.reset(robot_.position);
  }
  void command(HandAction action, double position) {
    HandCommand c;
    c.action = action;
    c.position = Vector::Constant(4, position);
    c.pull_force = 4.0;
    ASSERT_EQ(hand_.accept(c), "");
  }
  void grasp_at(double position, const Vector& effort) {
    HandCommand c;
    c.action = HandAction::grasp;
    c.position = Vector::Constant(4, position);
    c.effort = effort;
    ASSERT_EQ(hand_.accept(c), "");
  }
  /// Closes on an object that every finger meets at 0.5 rad.
  void grasp_object() {
    block_.assign(4, 0.5);
    command(HandAction::grasp, 0.7);
    run(3.0);
    ASSERT_EQ(hand_.state(), HandState::grasped);
  }
  /// The hand is stopped and joins the robot again, as after a stop of all drives.
  void stop_and_rejoin() {
    may_move_ = false;
    run(0.3);
    hand_.follow(robot_.position, 0.1);
    may_move_ = true;
  }
  /// The hand holds an object, offers it, and a person begins to pull.
  void pull_for(double seconds) {
    ASSERT_NO_FATAL_FAILURE(grasp_object());
    command(HandAction::release_on_pull, 0.0);
    run(1.0);
    firm_ = hand_.effort(0);
    force_ += Vector3(8.0, 0, 2.0);
    run(seconds);
  }
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / kDt); ++k) {
      for (int i = 0; i < 4; ++i) {
        const double before = robot_.position[i];
        robot_.position[i] = std::min(out_.position[i] + hand_.effort(i) / kStiffness,
                                      block_[static_cast<std::size_t>(i)]);
        robot_.velocity[i] = (robot_.position[i] - before) / kDt;
        robot_.effort[i] = jammed_[static_cast<std::size_t>(i)] *
                           (kStiffness * (out_.position[i] - robot_.position[i]) + hand_.effort(i));
      }
      HandInputs in;
      in.robot = &robot_;
      in.payload = robot_.payload;
      in.new_state = true;
      in.force = force_ + noise(k);
      in.toward = Vector3::UnitX();
      in.person_distance = person_distance_;
      in.may_move = may_move_;
      hand_.step(in, kDt, now_, out_);
      now_ += from_seconds(kDt);
    }
  }
  Vector3 noise(int) {
    std::normal_distribution<double> n(0.0, 0.5);
    return Vector3(n(random_), n(random_), n(random_));
  }

  HandExecutor hand_;
  MotionState3 out_;
  RobotState robot_;
  std::vector<double> block_;
  std::array<double, 4> jammed_{1, 1, 1, 1};  // fraction of the effort that reaches the object
  Vector3 force_{0, 0, -3.0};
  double firm_{};  // effort of a finger before the person pulled [Nm]
  double person_distance_{0.1};
  bool may_move_{true};
  TimePoint now_{from_seconds(10)};
  std::mt19937 random_{7};
};

TEST_F(HandTest, moves_to_a_position_and_says_idle) {
  command(HandAction::move, 0.8);
  EXPECT_EQ(hand_.state(), HandState::moving);
  run(1.5);
  EXPECT_EQ(hand_.state(), HandState::idle);
  EXPECT_NEAR(out_.position[2], 0.8, 1e-9);
}

TEST_F(HandTest, grasps_what_is_in_the_way_and_keeps_squeezing) {
  block_ = {0.5, 0.55, 0.6, 10.0};
  command(HandAction::grasp, 0.7);
  run(3.0);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  for (int i : {0, 1, 2}) {
    EXPECT_NEAR(out_.position[i], robot_.position[i], 0.01) << i;
    EXPECT_NEAR(robot_.effort[i], HandSettings{}.grip_effort, 0.15) << i;
  }
}

TEST_F(HandTest, finds_contact_a_little_beyond_the_commanded_position) {
  block_ = {0.75, 0.75, 0.8, 0.8};
  command(HandAction::grasp, 0.7);
  run(3.0);
  EXPECT_EQ(hand_.state(), HandState::grasped);
}

TEST_F(HandTest, fingers_open_only_after_the_grip_force_is_gone) {
  ASSERT_NO_FATAL_FAILURE(grasp_object());
  const Vector closed = out_.position;
  command(HandAction::release, 0.3);
  EXPECT_EQ(hand_.state(), HandState::moving);
  int still_gripping = 0;
  for (double t = 0; t < 1.5 && hand_.state() == HandState::moving; t += kDt) {
    run(kDt);
    if (hand_.effort(0) == 0) continue;
    ++still_gripping;
    ASSERT_EQ(out_.position, closed) << "after " << t << " s with " << hand_.effort(0) << " Nm";
  }
  EXPECT_NEAR(still_gripping * kDt, HandSettings{}.grip_rise_time, 0.01);
  EXPECT_EQ(hand_.state(), HandState::released);
  EXPECT_NEAR(out_.position[0], 0.3, 1e-9);
}

TEST_F(HandTest, a_release_that_is_paused_goes_on_afterwards) {
  ASSERT_NO_FATAL_FAILURE(grasp_object());
  command(HandAction::release, 0.3);
  run(0.5 * HandSettings{}.grip_rise_time);
  const double half = hand_.effort(0);
  may_move_ = false;
  run(1.0);
  EXPECT_EQ(hand_.effort(0), half) << "a stop drops nothing";
  may_move_ = true;
  run(1.5);
  EXPECT_EQ(hand_.state(), HandState::released);
}

TEST_F(HandTest, once_it_has_released_a_finger_gives_way_to_what_is_drawn_past_it) {
  ASSERT_NO_FATAL_FAILURE(grasp_object());
  block_[0] = 0.45;
  run(1.0);
  EXPECT_GT(out_.position[0], 0.45) << "what it holds presses it, and it holds on";
  command(HandAction::release, 0.3);
  run(1.5);
  ASSERT_EQ(hand_.state(), HandState::released);
  block_[0] = 0.1;
  run(0.5);
  EXPECT_LT(out_.position[0], 0.1 + 1.1 * HandSettings{}.yield_effort / kStiffness);
  EXPECT_NEAR(out_.position[1], 0.3, 1e-9) << "nothing presses it";
  EXPECT_EQ(hand_.state(), HandState::released);
}

/// One axis that slides, as a parallel gripper has: the same settings, at the lever of a finger.
TEST(SlidingHand, closes_until_it_presses_and_tells_metres) {
  const HandSettings settings;
  HandExecutor hand(settings, {{0}, {0.0}, {0.04}, {1}}, limits(1, 0.08, 0.5, 5),
                    limits(1, 0.1, 0.8, 10));
  constexpr double kSpring = 1.4e4, kObject = 0.021;  // [N/m], [m]
  MotionState3 out = rest_state(Vector::Constant(1, 0.04));
  RobotState robot;
  robot.position = Vector::Constant(1, 0.04);
  robot.velocity = robot.effort = Vector::Zero(1);
  hand.reset(robot.position);
  HandCommand wide;
  wide.position = Vector::Constant(1, 0.05);
  EXPECT_NE(hand.accept(wide).find("] m"), std::string::npos);
  HandCommand grasp;
  grasp.action = HandAction::grasp;
  grasp.position = Vector::Constant(1, 0.022);
  grasp.effort = Vector::Constant(1, -50.0);
  ASSERT_EQ(hand.accept(grasp), "");
  TimePoint now{from_seconds(1)};
  double least = 1;
  for (int k = 0; k < 4000; ++k) {
    robot.position[0] = std::max(out.position[0] + hand.effort(0) / kSpring, kObject);
    robot.effort[0] = kSpring * (out.position[0] - robot.position[0]) + hand.effort(0);
    HandInputs in;
    in.robot = &robot;
    in.payload = robot.payload;
    in.new_state = in.may_move = true;
    hand.step(in, kDt, now, out);
    now += from_seconds(kDt);
    least = std::min(least, out.position[0]);
  }
  EXPECT_EQ(hand.state(), HandState::grasped);
  EXPECT_NEAR(robot.effort[0], -50.0, 15.0);
  EXPECT_GT(least, kObject - 0.001) << "went on closing though it touched";
}

TEST_F(HandTest, fingers_arrive_together_and_squeeze_along_the_way_they_came) {
  HandCommand c;
  c.action = HandAction::grasp;
  c.position = Eigen::Vector4d(0.2, 0.4, 0.15, 0.6);
  ASSERT_EQ(hand_.accept(c), "");
  bool together = true;
  for (int k = 0; k < 2500; ++k) {
    run(kDt);
    for (int i = 0; i < 4; ++i)
      together = together && std::abs(out_.position[i] / c.position[i] -
                                      out_.position[3] / c.position[3]) < 0.02;
  }
  EXPECT_TRUE(together) << "an axis ran ahead of the others";
  run(1.0);
  EXPECT_NEAR(out_.position[3], 0.6 + HandSettings{}.seek_travel, 1e-3);
  EXPECT_NEAR(out_.position[0], 0.2 + HandSettings{}.seek_travel / 3, 1e-3);
}

TEST_F(HandTest, a_limit_slows_a_motion_under_way_and_a_grasp_gets_no_faster) {
  hand_.limit_speed(0.2);
  command(HandAction::move, 1.0);
  double fastest = 0;
  for (int k = 0; k < 300; ++k) {
    run(kDt);
    fastest = std::max(fastest, std::abs(out_.velocity[0]));
  }
  EXPECT_LE(fastest, 0.2 * 2.5 + 1e-9);
  EXPECT_GT(fastest, 0.1 * 2.5);
  hand_.limit_speed(1.0);
  run(0.25);
  EXPECT_GT(std::abs(out_.velocity[0]), 0.3 * 2.5) << "a motion adapts";
  hand_.limit_speed(0.2);
  run(0.3);
  EXPECT_LE(std::abs(out_.velocity[0]), 0.2 * 2.5 + 1e-9);
  run(4);
  command(HandAction::grasp, 0.0);
  hand_.limit_speed(1.0);
  fastest = 0;
  for (int k = 0; k < 1000; ++k) {
    run(kDt);
    fastest = std::max(fastest, std::abs(out_.velocity[0]));
  }
  EXPECT_LE(fastest, 0.2 * HandSettings{}.grasp_speed * 2.5 + 1e-9);
}

TEST_F(HandTest, the_squeeze_it_is_given_grows_smoothly_is_kept_and_decays_when_the_hand_opens) {
  block_ = {0.5, 0.5, 10.0, 0.5};
  HandCommand c;
  c.action = HandAction::grasp;
  c.position = Vector::Constant(4, 0.5);
  c.effort = Eigen::Vector4d(0.8, 1.2, 0.0, 0.3);
  ASSERT_EQ(hand_.accept(c), "");
  double before = 0, steepest = 0;
  for (int k = 0; k < 2500; ++k) {
    run(kDt);
    steepest = std::max(steepest, std::abs(hand_.effort(1) - before));
    before = hand_.effort(1);
  }
  EXPECT_EQ(hand_.state(), HandState::grasped);
  EXPECT_LE(steepest, 1.2 * kDt / HandSettings{}.grip_rise_time + 1e-9);
  for (int i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(hand_.effort(i), c.effort[i]) << i;
    EXPECT_GE(robot_.effort[i], (i == 2 ? 0.0 : c.effort[i]) - 1e-6) << i;
    EXPECT_LE(robot_.effort[i], (i == 2 ? 0.0 : c.effort[i]) + 0.6)
        << i << ": and what the search for contact left";
  }
  HandCommand again;
  again.action = HandAction::grasp;
  again.position = out_.position;
  ASSERT_EQ(hand_.accept(again), "");
  run(1.0);
  EXPECT_EQ(hand_.state(), HandState::grasped) << "told to keep what it holds";
  EXPECT_DOUBLE_EQ(hand_.effort(1), 1.2);
  may_move_ = false;
  run(0.5);
  EXPECT_DOUBLE_EQ(hand_.effort(1), 1.2) << "a pause drops nothing";
  may_move_ = true;
  command(HandAction::release, 0.0);
  run(HandSettings{}.grip_rise_time + 0.01);
  EXPECT_DOUBLE_EQ(hand_.effort(1), 0.0);
  run(1.5);
  EXPECT_EQ(hand_.state(), HandState::released);
}

TEST_F(HandTest, what_a_person_holds_too_is_grasped_only_when_every_finger_pushes_as_it_should) {
  const auto squeeze = [this](double person_distance) {
    command(HandAction::release, 0.0);
    run(2.0);
    person_distance_ = person_distance;
    jammed_ = {1.0, 1.0, 0.3, 1.0};
    block_ = {0.5, 0.5, 0.5, 0.5};
    grasp_at(0.5, Eigen::Vector4d(1.2, 1.2, 1.2, 0.3));
    run(2.5);
  };
  squeeze(0.1);
  EXPECT_EQ(hand_.state(), HandState::empty)
      << "one finger pushes with a third of its effort: it lies against something else";
  squeeze(10.0);
  EXPECT_EQ(hand_.state(), HandState::grasped)
      << "nobody else keeps it where it is: it has come to rest in the hand";
}

TEST_F(HandTest, the_grip_force_does_not_wait_for_a_finger_that_finds_nothing) {
  block_ = {0.5, 0.5, 0.5, 10.0};
  grasp_at(0.5, Eigen::Vector4d(1.2, 1.2, 1.2, 0.6));
  const auto is_touching = [this] { return robot_.effort[0] > 0.1; };
  for (int k = 0; k < 300 && !is_touching(); ++k) run(0.01);
  ASSERT_TRUE(is_touching());
  run(0.6);
  EXPECT_GT(robot_.effort[0], 0.9 * 1.2) << "a person who feels the fingers lets go at once";
  run(2.0);
  EXPECT_NEAR(out_.position[3], 0.5 + 0.5 * HandSettings{}.seek_travel, 1e-3)
      << "the other finger still searches";
}

TEST_F(HandTest, a_grasp_in_doubt_is_grasped_once_the_person_has_left_the_object_to_the_fingers) {
  jammed_ = {1.0, 1.0, 0.3, 1.0};
  block_ = {0.5, 0.5, 0.5, 0.5};
  grasp_at(0.5, Eigen::Vector4d(1.2, 1.2, 1.2, 0.3));
  run(3.5);
  ASSERT_EQ(hand_.state(), HandState::empty) << "a person may still hold the object";
  person_distance_ = 10.0;
  run(0.5);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  block_ = {10, 10, 10, 10};  // the object is removed
  jammed_ = {0, 0, 0, 0};
  command(HandAction::grasp, 0.7);
  run(3.0);
  person_distance_ = 0.1;
  run(0.5);
  person_distance_ = 10.0;
  run(0.5);
  EXPECT_EQ(hand_.state(), HandState::empty) << "fingers that press on nothing hold nothing";
}

TEST_F(HandTest, a_grasp_that_moves_no_finger_and_names_no_effort_ends) {
  command(HandAction::grasp, 0.0);
  run(2.0);
  EXPECT_EQ(hand_.state(), HandState::empty);
}

TEST_F(HandTest, closing_on_nothing_is_empty) {
  command(HandAction::grasp, 0.7);
  run(3.0);
  EXPECT_EQ(hand_.state(), HandState::empty);
}

TEST_F(HandTest, an_object_lost_from_the_grasp_is_noticed) {
  block_ = {0.5, 0.5, 0.5, 0.5};
  command(HandAction::grasp, 0.7);
  run(2.5);
  robot_.payload = 0.3;
  run(0.5);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  robot_.payload = 0.0;
  run(0.5);
  EXPECT_EQ(hand_.state(), HandState::empty);
}

TEST_F(HandTest, hold_pauses_and_resuming_finishes) {
  command(HandAction::move, 1.2);
  run(0.1);
  may_move_ = false;
  run(0.5);
  const double held = out_.position[0];
  EXPECT_LT(held, 1.0);
  EXPECT_EQ(out_.velocity[0], 0.0);
  run(0.5);
  EXPECT_EQ(out_.position[0], held);
  may_move_ = true;
  run(1.0);
  EXPECT_NEAR(out_.position[0], 1.2, 1e-9);
  EXPECT_EQ(hand_.state(), HandState::idle);
}

TEST_F(HandTest, opens_when_the_person_pulls) {
  block_ = {0.5, 0.5, 0.5, 0.5};
  command(HandAction::grasp, 0.7);
  run(2.5);
  command(HandAction::release_on_pull, 0.0);
  run(2.0);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  const double squeezed = hand_.effort(0);
  force_ += Vector3(8.0, 0, 2.0);
  run(0.45);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  EXPECT_NEAR(hand_.effort(0), HandSettings{}.loosen_fraction * squeezed, 1e-9)
      << "loosened, but still pressing";
  run(0.2);
  EXPECT_EQ(hand_.state(), HandState::moving);
  run(1.5);
  EXPECT_EQ(hand_.state(), HandState::released);
}

TEST_F(HandTest, a_grip_loosened_before_a_stop_is_firm_again_and_a_pull_still_opens_it) {
  ASSERT_NO_FATAL_FAILURE(pull_for(0.3));
  ASSERT_LT(hand_.effort(0), 0.9 * firm_) << "loosened";
  force_ = {0, 0, -3.0};
  stop_and_rejoin();
  run(1.0);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  EXPECT_NEAR(hand_.effort(0), firm_, 1e-9);
  force_ += Vector3(8.0, 0, 2.0);
  run(2.0);
  EXPECT_EQ(hand_.state(), HandState::released);
}

TEST_F(HandTest, a_stop_before_the_pull_leaves_the_offer_in_force) {
  ASSERT_NO_FATAL_FAILURE(grasp_object());
  command(HandAction::release_on_pull, 0.0);
  run(0.5);
  stop_and_rejoin();
  run(1.0);
  EXPECT_EQ(hand_.state(), HandState::grasped);
  force_ += Vector3(8.0, 0, 2.0);
  run(2.0);
  EXPECT_EQ(hand_.state(), HandState::released);
}

TEST_F(HandTest, who_still_pulls_when_an_interrupted_hand_grips_again_is_felt) {
  person_distance_ = 2.0;
  ASSERT_NO_FATAL_FAILURE(grasp_object());
  run(1.0);
  person_distance_ = 0.1;
  command(HandAction::release_on_pull, 0.0);
  run(1.0);
  force_ += Vector3(8.0, 0, 2.0);
  run(0.7);
  ASSERT_EQ(hand_.state(), HandState::moving);
  stop_and_rejoin();
  command(HandAction::release, 0.0);
  run(0.05);
  stop_and_rejoin();
  ASSERT_EQ(hand_.state(), HandState::refused);
  command(HandAction::grasp, 0.7);
  run(2.5);
  ASSERT_EQ(hand_.state(), HandState::grasped);
  for (int offers = 0; offers < 2; ++offers) {
    command(HandAction::grasp, 0.7);  // as after a refused offer
    run(0.5);
  }
  command(HandAction::release_on_pull, 0.0);
  run(2.5);
  EXPECT_EQ(hand_.state(), HandState::released) << "by the pull that has not changed";
}

TEST_F(HandTest, an_opening_that_a_stop_interrupts_is_reported_and_presses_no_more) {
  ASSERT_NO_FATAL_FAILURE(pull_for(0.7));
  ASSERT_EQ(hand_.state(), HandState::moving);
  stop_and_rejoin();
  const double position = out_.position[0];
  run(1.0);
  EXPECT_EQ(hand_.state(), HandState::refused);
  EXPECT_GT(position, 0.0) << "still on the way";
  EXPECT_NEAR(out_.position[0], position, 0.02) << "the planner says what follows";
  EXPECT_EQ(hand_.effort(0), 0.0);
  command(HandAction::release, 0.0);
  run(1.5);
  EXPECT_EQ(hand_.state(), HandState::released);
}

TEST_F(HandTest, an_offer_after_an_interrupted_opening_is_accepted) {
  ASSERT_NO_FATAL_FAILURE(pull_for(0.7));
  stop_and_rejoin();
  run(1.0);
  ASSERT_EQ(hand_.state(), HandState::refused);
  command(HandAction::release_on_pull, 0.0);
  run(0.1);
  EXPECT_EQ(hand_.state(), HandState::idle) << "the stop concerned the command before";
}

TEST_F(HandTest, does_not_open_for_bumps_tremor_pushes_or_without_a_hand) {
  block_ = {0.5, 0.5, 0.5, 0.5};
  command(HandAction::grasp, 0.7);
  run(2.5);
  command(HandAction::release_on_pull, 0.0);
  run(1.0);
  const Vector3 rest = force_;
  for (int bump = 0; bump < 10; ++bump) {
    force_ = rest + Vector3(25.0, 0, 0);
    run(0.03);
    force_ = rest;
    run(0.3);
  }
  EXPECT_EQ(hand_.state(), HandState::grasped) << "bump";
  for (int k = 0; k < 2000; ++k) {
    force_ = rest + Vector3(6.0 * std::sin(2 * M_PI * 8.0 * k * kDt), 0, 0);
    run(kDt * 1.5);
  }
  force_ = rest;
  run(0.3);
  EXPECT_EQ(hand_.state(), HandState::grasped) << "tremor";
  force_ = rest + Vector3(-10.0, 0, 0);
  run(0.5);
  EXPECT_EQ(hand_.state(), HandState::grasped) << "push";
  force_ = rest;
  run(0.3);
  person_distance_ = 1.0;
  force_ = rest + Vector3(10.0, 0, 0);
  run(0.5);
  EXPECT_EQ(hand_.state(), HandState::grasped) << "nobody's hand there";
}

TEST_F(HandTest, refuses_what_it_cannot_do) {
  HandCommand c;
  c.position = Vector::Zero(3);
  EXPECT_NE(hand_.accept(c), "");
  c.position = Vector::Constant(4, 5.0);
  EXPECT_NE(hand_.accept(c), "");
  c.position = Vector::Constant(4, std::numeric_limits<double>::quiet_NaN());
  EXPECT_NE(hand_.accept(c), "");
  c.position = Vector::Zero(4);
  for (const double effort : {100.0, std::numeric_limits<double>::quiet_NaN()}) {
    c.effort = Vector::Constant(4, effort);
    EXPECT_NE(hand_.accept(c), "");
  }
  c.effort = Vector::Zero(2);
  EXPECT_NE(hand_.accept(c), "");
  c.effort = Vector();
  c.action = HandAction::release_on_pull;
  c.pull_force = 0.0;
  EXPECT_NE(hand_.accept(c), "");
}

/// Returns the final grip when a person pulls at the load of 3 N with 4 N from before the watch is
/// armed until its end.
Grip pulled_before_the_offer(bool load_felt_before) {
  ReleaseWatch watch{PullSettings{}};
  const Vector3 load(0, 0, -3), toward(1, 0, 0);
  TimePoint now{from_seconds(10)};
  for (int k = 0; k < 500 && load_felt_before; ++k) watch.bear(load, now += from_seconds(0.002));
  watch.arm(1.5);
  for (int k = 0; k < 1000; ++k)
    watch.update({load + 4.0 * toward, toward, true, true}, now += from_seconds(0.002));
  return watch.grip();
}

TEST(ReleaseWatch, a_pull_from_before_the_offer_counts_where_the_load_was_felt_alone) {
  EXPECT_EQ(pulled_before_the_offer(true), Grip::open);
  EXPECT_EQ(pulled_before_the_offer(false), Grip::hold) << "nothing tells it from the load";
}

}  // namespace
}  // namespace handsel::trajectory_controller::hand_executor_test
