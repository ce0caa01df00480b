// SPDX-License-Identifier: Apache-2.0
// Each example driver in virtual time with the real controller and an emulated robot controller:
// lost messages, jitter, jumps, reflexes, limits near the joint ends, the gripper, the load; and
// hostile datagrams.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "deploy/drivers/fakes/fake_script.hpp"
#include "tests/support/controller_bench.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::driver_stories_test {
namespace {

using drivers::FakeCyclicArm;
using drivers::FakeReflexArm;
using test::ControllerBench;

const std::vector<int> kArm = {0, 1, 2};
constexpr double kDeceleration = 3.0;

drivers::DriverSettings checked() {
  drivers::DriverSettings settings;
  settings.watch.period = 0.001;
  return settings;
}

/// Controller, driver and maker's side in one virtual time.
class Stage {
 public:
  virtual ~Stage() = default;

  void tick() {
    const double now = to_seconds(bench.now.time_since_epoch());
    if (bench.ticks % cycle_ticks_ == 0) {
      fake().cycle();
      driver().cycle(now);
    }
    state = driver().state();
    if (bench.ticks % 2 == 0) bench.core.on(state, bench.now);
    if (!bench.tick() || !wire_holds) return;
    JointCommand c;
    c.robot = "small";
    c.position = bench.core.set_point().position;
    c.velocity = bench.core.set_point().velocity;
    c.acceleration = bench.core.set_point().acceleration;
    c.payload = bench.core.hands().payload();
    c.sequence = ++sequence;
    if (late > 0) {
      --late;
      return;
    }
    driver().command(c, now);
  }
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / 0.001 + 0.5); ++k) tick();
  }
  /// Enabled, in mode normal.
  void start() {
    run(0.5);
    ++bench.go.epoch;
    run(0.5);
    ASSERT_EQ(bench.core.mode(), Mode::normal) << driver().trouble();
  }
  void go_to(double a, double b, double c) {
    ASSERT_EQ(bench.go_to(ControllerBench::arm(a, b, c), ++id_), "");
  }
  double now() const { return to_seconds(bench.now.time_since_epoch()); }

  virtual drivers::FakeArm& fake() = 0;
  virtual drivers::Driver& driver() = 0;

  ControllerBench bench;
  RobotState state;
  bool wire_holds{true};
  std::uint64_t sequence{};  ///< of the set-point sent last
  int late{};                ///< so many of the next set-points are lost

 protected:
  explicit Stage(int cycle_ticks) : cycle_ticks_(cycle_ticks) { bench.robot_speaks = false; }

 private:
  int cycle_ticks_;
  std::uint64_t id_{};
};

class CyclicStage : public Stage {
 public:
  CyclicStage()
      : Stage(5),
        fake_(*bench.robot, kArm, 0.005),
        arm_(*bench.robot, kArm, 0.005, fake_, checked()) {}
  drivers::FakeArm& fake() override { return fake_; }
  drivers::Driver& driver() override { return arm_; }

 private:
  FakeCyclicArm fake_;
  drivers::PositionArm arm_;
};

class ReflexStage : public Stage {
 public:
  ReflexStage()
      : Stage(1),
        fake_(*bench.robot, kArm, kDeceleration),
        arm_(*bench.robot, kArm, fake_, settings()) {}
  FakeReflexArm& fake() override { return fake_; }
  drivers::Driver& driver() override { return arm_; }

 private:
  static drivers::ReflexSettings settings() {
    drivers::ReflexSettings s;
    s.common = checked();
    s.joint_deceleration = kDeceleration;
    s.gripper.axis = 3;
    s.gripper.open = 0.0;
    s.gripper.closed = 1.2;
    return s;
  }
  FakeReflexArm fake_;
  drivers::ReflexArm arm_;
};

template <class S>
class AnyDriver : public testing::Test {
 protected:
  S stage_;
};
using Stages = testing::Types<CyclicStage, ReflexStage>;
TYPED_TEST_SUITE(AnyDriver, Stages);

TYPED_TEST(AnyDriver, lost_set_points_stop_softly_and_are_taken_up_again_without_a_person) {
  auto& s = this->stage_;
  s.start();
  s.go_to(1.2, 0.4, -0.5);
  s.run(1.2);
  s.wire_holds = false;
  s.run(0.06);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << "nobody has stopped the drives";
  EXPECT_NE(s.state.refusal.find("no set-point for"), std::string::npos) << s.state.refusal;
  EXPECT_FALSE(s.driver().core().following());
  s.run(2.0);
  EXPECT_EQ(s.fake().speed(), 0.0);
  s.wire_holds = true;
  s.run(3.0);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << s.driver().trouble();
  EXPECT_EQ(s.state.refusal, "");
  EXPECT_TRUE(s.driver().core().following()) << s.driver().trouble();
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
}

TYPED_TEST(AnyDriver, a_wire_and_a_maker_that_jitter_never_make_the_references_jump) {
  const unsigned seed = 11;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  auto& s = this->stage_;
  s.start();
  for (int stroke = 0; stroke < 4; ++stroke) {
    s.go_to(stroke % 2 ? 0.0 : 1.0, stroke % 2 ? 0.0 : 0.4, stroke % 2 ? 0.0 : -0.5);
    for (int k = 0; k < 4000; ++k) {
      if (k % 40 == 0) s.late = 1 + static_cast<int>(random() % 12);
      if (k % 50 == 7) s.fake().events.drop = 1 + static_cast<int>(random() % 2);
      s.tick();
    }
    s.late = s.fake().events.drop = 0;
    s.run(1.0);
    ASSERT_EQ(s.bench.core.status().motion, MotionState::finished)
        << s.bench.core.status().reason << "; " << s.driver().trouble();
  }
  EXPECT_NEAR(s.fake().position()[0], 0.0, 1e-3);
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
}

TYPED_TEST(AnyDriver, a_state_with_an_axis_too_few_is_taken_for_a_lost_one) {
  auto& s = this->stage_;
  s.start();
  s.go_to(1.2, 0.4, -0.5);
  s.run(1.0);
  s.fake().events.foreign = 2;
  s.run(0.5);
  EXPECT_EQ(s.fake().events.foreign, 0);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << s.driver().trouble();
  s.run(5.0);
  EXPECT_EQ(s.bench.core.status().motion, MotionState::finished) << s.bench.core.status().reason;
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
}

TYPED_TEST(AnyDriver, a_set_point_that_jumps_never_reaches_the_arm) {
  auto& s = this->stage_;
  s.start();
  JointCommand c;
  c.sequence = ++s.sequence;
  c.position = s.bench.core.set_point().position;
  c.velocity = c.acceleration = Vector::Zero(7);
  c.position[1] += 0.2;
  EXPECT_FALSE(s.driver().command(c, s.now()));
  EXPECT_EQ(s.driver().core().refused(), 1u);
  s.run(0.1);
  EXPECT_EQ(s.fake().account.violations, 0);
}

TYPED_TEST(AnyDriver, what_the_hand_holds_is_told_to_the_maker_with_the_set_point_that_says_so) {
  auto& s = this->stage_;
  s.start();
  JointCommand c;
  c.sequence = ++s.sequence;
  c.position = s.bench.core.set_point().position;
  c.velocity = c.acceleration = Vector::Zero(7);
  c.payload = 0.4;
  EXPECT_TRUE(s.driver().command(c, s.now()));
  EXPECT_EQ(s.fake().account.load, 0.4);
  JointCommand jumps = c;
  jumps.sequence = ++s.sequence;
  jumps.payload = 0.9;
  jumps.position[1] += 0.2;
  EXPECT_FALSE(s.driver().command(jumps, s.now()));
  EXPECT_EQ(s.fake().account.load, 0.4) << "nothing of a set-point that is refused";
  s.run(0.1);  // the refused set-point stops the robot; it follows again set-points at rest at its
  // position
  EXPECT_EQ(s.fake().account.load, 0.0) << "the controller says that nothing is held";
}

TYPED_TEST(AnyDriver, a_silent_maker_stops_the_robot_and_it_goes_on_with_a_new_permission) {
  auto& s = this->stage_;
  s.start();
  s.go_to(1.2, 0.4, -0.5);
  s.run(1.0);
  s.fake().events.drop = 60;
  s.run(0.1);
  // The reflex arm answers lost messages with a reflex, which a person must reset; the position arm
  // only waits.
  constexpr bool kReflex = std::is_same_v<TypeParam, ReflexStage>;
  EXPECT_EQ(s.state.mode, kReflex ? DriveMode::protective_stop : DriveMode::braked);
  const std::string why = s.driver().trouble();
  EXPECT_TRUE(why.find("silent") != std::string::npos ||
              why.find("no command") != std::string::npos)
      << why;
  EXPECT_EQ(s.bench.core.mode(), Mode::stop);
  s.run(5.0);
  if (s.driver().core().waits_for_person()) s.driver().acknowledge();
  s.run(1.0);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << s.driver().trouble();
  EXPECT_EQ(s.bench.core.mode(), Mode::hold);
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
}

TEST(PositionArm, two_lost_messages_are_ridden_out) {
  CyclicStage s;
  s.start();
  s.go_to(1.2, 0.4, -0.5);
  s.run(1.0);
  s.fake().events.drop = 2;
  s.run(0.5);
  EXPECT_EQ(s.state.mode, DriveMode::enabled);
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
  EXPECT_EQ(s.fake().account.sessions, 1);
}

TEST(ReflexArm, a_reflex_ends_by_a_person_and_a_new_permission_only) {
  ReflexStage s;
  s.start();
  s.go_to(1.2, 0.4, -0.5);
  s.run(1.2);
  s.fake().events.push = 30.0;
  s.run(0.05);
  EXPECT_EQ(s.state.mode, DriveMode::protective_stop);
  EXPECT_NE(s.driver().trouble().find("reflex: push on shoulder_turn"), std::string::npos)
      << s.driver().trouble();
  s.driver().acknowledge();
  s.run(0.5);
  EXPECT_EQ(s.fake().account.sessions, 0) << "somebody still pushes";
  s.fake().events.push = 0.0;
  s.run(2.0);
  EXPECT_EQ(s.state.mode, DriveMode::protective_stop) << "it never recovers by itself";
  s.driver().acknowledge();
  s.run(2.0);
  EXPECT_EQ(s.fake().account.sessions, 1);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << s.driver().trouble();
  EXPECT_EQ(s.bench.core.mode(), Mode::hold);
  ++s.bench.go.epoch;
  s.run(0.3);
  s.go_to(0.2, 0.1, -0.2);
  s.run(5.0);
  EXPECT_EQ(s.bench.core.status().motion, MotionState::finished);
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
}

TEST(ReflexArm, velocity_limits_shrink_toward_the_ends_and_are_kept_by_stopping_before) {
  EXPECT_DOUBLE_EQ(drivers::velocity_toward_end(0.0, 2.0, 0.5, 3.0), 0.5);
  EXPECT_NEAR(drivers::velocity_toward_end(1.99, 2.0, 0.5, 3.0), std::sqrt(0.06), 1e-12);
  EXPECT_EQ(drivers::velocity_toward_end(2.1, 2.0, 0.5, 3.0), 0.0);
  ReflexStage s;
  s.start();
  s.go_to(0.0, 1.99, 0.0);
  s.run(8.0);
  EXPECT_EQ(s.bench.core.status().motion, MotionState::finished);
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
  JointCommand c;
  c.sequence = ++s.sequence;
  c.position = s.bench.core.set_point().position;
  c.velocity = c.acceleration = Vector::Zero(7);
  c.velocity[1] = 0.5;
  EXPECT_FALSE(s.driver().command(c, s.now()));
  EXPECT_NE(s.driver().trouble().find("shoulder at 1.99"), std::string::npos)
      << s.driver().trouble();
  s.run(0.2);
  EXPECT_EQ(s.fake().account.violations, 0) << s.fake().account.last_violation;
}

TEST(ReflexArm, the_gripper_closes_with_a_force_that_grows_with_the_squeeze_and_opens_by_width) {
  ReflexStage s;
  s.fake().events.object = 0.05;
  s.start();
  HandCommand c;
  c.robot = "small";
  c.id = 5;
  c.epoch = s.bench.go.epoch;
  c.action = HandAction::grasp;
  c.position = Vector(2);
  c.position << 1.0, 0.0;
  ASSERT_EQ(s.bench.core.accept(c, Duration(0), s.bench.now), "");
  s.run(4.0);
  EXPECT_GT(s.fake().account.grasps, 0);
  EXPECT_NEAR(s.fake().width(), 0.05, 1e-3);
  EXPECT_GE(s.fake().account.grasp_force, 5.0);
  EXPECT_LE(s.fake().account.grasp_force, 40.0);
  c.id = 6;
  c.action = HandAction::release;
  c.position << 0.0, 0.0;
  ASSERT_EQ(s.bench.core.accept(c, Duration(0), s.bench.now), "");
  s.run(3.0);
  EXPECT_NEAR(s.fake().width(), 0.08, 1e-3);
  EXPECT_EQ(s.bench.core.status().hand, HandState::released);
}

TEST(MakerUdp, what_is_sent_is_read_and_nothing_malformed_is) {
  const unsigned seed = 5;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  drivers::ReflexState state, read;
  state.cycle = 77;
  state.mode = drivers::ArmMode::reflex;
  state.position = state.velocity = state.torque = state.external_torque =
      Vector::LinSpaced(7, -1.0, 1.0);
  state.wrist_wrench.force = Vector3(1, 2, 3);
  state.gripper_width = 0.04;
  state.error = "velocity";
  const std::string good = drivers::encode(state);
  ASSERT_TRUE(drivers::decode(good, read));
  EXPECT_EQ(drivers::encode(read), good);
  drivers::CyclicState cyclic;
  drivers::Order order;
  EXPECT_FALSE(drivers::decode(good, cyclic)) << "another kind";
  EXPECT_FALSE(drivers::decode(good, order));
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_FALSE(drivers::decode(good.substr(0, n), read)) << n;
  EXPECT_FALSE(drivers::decode(good + "x", read));
  int taken = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string bad = good;
    for (int i = 0; i < 3; ++i) bad[random() % bad.size()] = static_cast<char>(random());
    if (!drivers::decode(bad, read)) continue;
    ++taken;
    EXPECT_TRUE(read.position.allFinite() && read.velocity.allFinite());
    EXPECT_EQ(read.position.size(), read.external_torque.size());
    EXPECT_LE(static_cast<int>(read.mode), static_cast<int>(drivers::ArmMode::emergency_stopped));
  }
  EXPECT_LT(taken, 19000);
}

TEST(FakeScript, a_line_that_cannot_be_read_is_named) {
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    return test::message_of<ConfigError>(
        [&] { drivers::load_fake_script(folder.write("s.txt", text)); });
  };
  EXPECT_EQ(
      drivers::load_fake_script(
          folder.write("s.txt", "# quiet\nmoving 0.2 brake on # now\n\nstanding 1 brake off\n"))
          .size(),
      2u);
  EXPECT_NE(
      refusal("moving 0.2 brake on\nlater 1 brake off\n").find("s.txt:2: \"later\" is no moment"),
      std::string::npos);
  EXPECT_NE(refusal("after x brake on\n").find("wants a number"), std::string::npos);
  EXPECT_NE(refusal("after 1 brake maybe\n").find("on or off"), std::string::npos);
  EXPECT_NE(refusal("after 1 explode\n").find("\"explode\" does not happen"), std::string::npos);
  EXPECT_NE(refusal("after 1 push hard\n").find("wants a number"), std::string::npos);
}

}  // namespace
}  // namespace handsel::driver_stories_test
