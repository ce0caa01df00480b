// The first day on hardware, told to both example drivers in front of scripted makers' sides: dry run, walls, override, emergency stop,
// user stop, brake; and what each kind has of its own. The controller is the real one.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/controller_bench.hpp"
#include "tests/support/fake_arms.hpp"

namespace handsel {
namespace {

using test::ControllerBench;
using trajectory_controller::ControllerSettings;
using trajectory_controller::Wall;

const std::vector<int> kArm = {0, 1, 2};
constexpr double kDeceleration = 3.0;

/// Controller, driver and maker's side in one virtual time.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual RobotState cycle(double now) = 0;
  virtual void command(const JointCommand& c, double now) = 0;
  virtual test::ArmScript& script() = 0;
  virtual const Vector& arm_position() const = 0;
  virtual int violations() const = 0;
  virtual int commanded() const = 0;
  virtual const drivers::DriverCore& driver() const = 0;
  virtual double told_load(double mass) = 0;

  explicit Stage(const ControllerSettings& settings) : bench(settings) { bench.robot_speaks = false; }
  void tick() {
    const double now = to_seconds(bench.now.time_since_epoch());
    state = cycle(now);
    if (bench.ticks % 2 == 0) bench.core.on(state, bench.now);
    if (!bench.tick() || !wire_holds) return;
    JointCommand c;
    c.robot = "small";
    c.position = bench.core.set_point().position;
    c.velocity = bench.core.set_point().velocity;
    c.acceleration = bench.core.set_point().acceleration;
    command(c, now);
  }
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / 0.001 + 0.5); ++k) {
      const Vector before = arm_position();
      tick();
      fastest = std::max(fastest, (arm_position() - before).cwiseAbs().maxCoeff() / 0.001);
    }
  }
  /// Enabled, in mode normal.
  void start() {
    run(0.5);
    ++bench.go.epoch;
    run(0.5);
  }
  ControllerBench bench;
  RobotState state;
  bool wire_holds{true};
  double fastest{};  ///< of any arm axis [rad/s]
};

class CyclicStage : public Stage {
 public:
  CyclicStage(const ControllerSettings& settings, bool dry_run)
      : Stage(settings), fake(Vector::Zero(3), 0.002, 0.8), arm(*bench.robot, kArm, 0.002, fake, with(dry_run)) {}
  RobotState cycle(double now) override {
    if (bench.ticks % 2 == 0) {
      fake.cycle();
      arm.cycle(now);
    }
    return arm.state();
  }
  void command(const JointCommand& c, double now) override { arm.command(c, now); }
  test::ArmScript& script() override { return fake.script; }
  const Vector& arm_position() const override { return fake.position(); }
  int violations() const override { return fake.violations; }
  int commanded() const override { return fake.commanded; }
  const drivers::DriverCore& driver() const override { return arm.core(); }
  double told_load(double mass) override {
    arm.set_load(mass);
    return fake.load;
  }
  static drivers::DriverSettings with(bool dry_run) {
    drivers::DriverSettings s;
    s.dry_run = dry_run;
    return s;
  }
  test::FakeCyclicArm fake;
  drivers::PositionArm arm;
};

class ReflexStage : public Stage {
 public:
  ReflexStage(const ControllerSettings& settings, bool dry_run)
      : Stage(settings), fake(*bench.robot, kArm, Vector::Zero(3), kDeceleration), arm(*bench.robot, kArm, fake, with(dry_run)) {}
  RobotState cycle(double now) override {
    fake.cycle();
    arm.cycle(now);
    return arm.state();
  }
  void command(const JointCommand& c, double now) override { arm.command(c, now); }
  test::ArmScript& script() override { return fake.script; }
  const Vector& arm_position() const override { return fake.position(); }
  int violations() const override { return fake.violations; }
  int commanded() const override { return fake.commanded; }
  const drivers::DriverCore& driver() const override { return arm.core(); }
  double told_load(double mass) override {
    arm.set_load(mass);
    return fake.load;
  }
  static drivers::ReflexSettings with(bool dry_run) {
    drivers::ReflexSettings s;
    s.common.dry_run = dry_run;
    s.joint_deceleration = kDeceleration;
    s.gripper.axis = 3;
    s.gripper.open = 0.0;
    s.gripper.closed = 1.2;
    return s;
  }
  test::FakeReflexArm fake;
  drivers::ReflexArm arm;
};

using Maker = std::unique_ptr<Stage> (*)(const ControllerSettings&, bool dry_run);
template <class S>
std::unique_ptr<Stage> make(const ControllerSettings& settings, bool dry_run) {
  return std::make_unique<S>(settings, dry_run);
}

class FirstDay : public testing::TestWithParam<Maker> {
 protected:
  std::unique_ptr<Stage> stage(const ControllerSettings& settings = {}, bool dry_run = false) { return GetParam()(settings, dry_run); }
  /// Stops in the middle of a motion by `what`; the robot stands, and goes on only with a new permission, without a jump.
  void stopped_by(bool test::ArmScript::*what, DriveMode mode) {
    auto s = stage();
    s->start();
    ASSERT_EQ(s->bench.core.mode(), Mode::normal) << s->driver().reason();
    ASSERT_EQ(s->bench.go_to(ControllerBench::arm(1.2, 0.4, -0.5), 1), "");
    s->run(1.2);
    ASSERT_GT(s->arm_position()[0], 0.1);
    s->script().*what = true;
    s->run(0.1);
    EXPECT_EQ(s->state.mode, mode);
    EXPECT_EQ(s->bench.core.mode(), Mode::stop);
    EXPECT_TRUE(s->bench.core.status().causes & trajectory_controller::bit(Cause::drive_not_enabled));
    s->run(3.0);
    const Vector there = s->arm_position();
    EXPECT_NEAR(s->bench.core.set_point().position[0], there[0], 0.003) << "the set-points follow the robot";
    s->script().*what = false;
    s->run(1.0);
    EXPECT_EQ(s->state.mode, DriveMode::enabled) << s->driver().reason();
    EXPECT_EQ(s->bench.core.mode(), Mode::hold) << "nobody has given a new permission";
    EXPECT_TRUE(s->arm_position().isApprox(there, 0.01));
    ++s->bench.go.epoch;
    s->run(0.3);
    EXPECT_EQ(s->bench.core.mode(), Mode::normal);
    ASSERT_EQ(s->bench.go_to(ControllerBench::arm(0.2, 0.1, -0.2), 2), "");
    s->run(5.0);
    EXPECT_EQ(s->bench.core.status().motion, MotionState::finished);
    EXPECT_TRUE(s->arm_position().isApprox(ControllerBench::arm(0.2, 0.1, -0.2), 0.01));
    EXPECT_EQ(s->violations(), 0);
    EXPECT_LE(s->bench.worst_jerk, 1 + 1e-6);
  }
};

TEST_P(FirstDay, dry_run_is_everything_but_the_output) {
  auto s = stage({}, true);
  s->start();
  ASSERT_EQ(s->bench.core.mode(), Mode::normal) << s->driver().reason();
  ASSERT_EQ(s->bench.go_to(ControllerBench::arm(1.0, 0.4, -0.5), 1), "");
  s->run(6.0);
  EXPECT_EQ(s->bench.core.status().motion, MotionState::finished);
  EXPECT_NEAR(s->state.position[0], 1.0, 0.01) << "the posture it would have is reported";
  EXPECT_TRUE(s->arm_position().isZero(0.0)) << "but the arm has not moved";
  EXPECT_EQ(s->commanded(), 0);
  EXPECT_EQ(s->told_load(0.4), 0.0);
}

TEST_P(FirstDay, walls_are_not_passed) {
  ControllerSettings settings;
  settings.walls = {Wall{-Vector3::UnitY(), -0.5}};  // y stays below 0.5 m; the arm is 0.86 m long
  auto s = stage(settings);
  s->start();
  ASSERT_EQ(s->bench.go_to(ControllerBench::arm(1.5, 0.0, 0.0), 1), "");
  double furthest = 0.0;
  const std::vector<LinkCapsule> capsules = robot_capsules(*s->bench.robot);
  std::vector<Pose> links;
  for (int k = 0; k < 8000; ++k) {
    s->tick();
    s->bench.robot->forward(RobotModel::with(Vector::Zero(7), s->bench.robot->require_group("arm"), s->arm_position()), links);
    for (const LinkCapsule& c : capsules)
      furthest = std::max({furthest, (links[static_cast<std::size_t>(c.link)] * c.a).y() + c.radius,
                           (links[static_cast<std::size_t>(c.link)] * c.b).y() + c.radius});
  }
  EXPECT_GT(furthest, 0.3);
  EXPECT_LE(furthest, 0.5);
  EXPECT_TRUE(s->bench.core.guard_verdict().wall);
  EXPECT_NE(s->bench.core.status().reason.find("wall"), std::string::npos) << s->bench.core.status().reason;
  EXPECT_EQ(s->violations(), 0);
}

TEST_P(FirstDay, override_of_ten_percent_is_a_tenth_of_the_speed) {
  auto s = stage();
  s->bench.go.override_factor = 0.1;
  s->start();
  s->fastest = 0.0;
  ASSERT_EQ(s->bench.go_to(ControllerBench::arm(1.5, 0.4, -0.5), 1), "");
  s->run(20.0);
  const double planned = s->bench.robot->comfort_limits().velocity[0];
  EXPECT_LE(s->fastest, 0.1 * planned * 1.01 * (GetParam() == make<CyclicStage> ? 2.0 : 1.0)) << "a cycle of 2 ms shows as one of 1 ms";
  EXPECT_GT(s->arm_position()[0], 0.5);
  EXPECT_EQ(s->violations(), 0);
}

TEST_P(FirstDay, emergency_stop) { stopped_by(&test::ArmScript::emergency, DriveMode::emergency_stop); }
TEST_P(FirstDay, user_stop) { stopped_by(&test::ArmScript::user_stop, DriveMode::user_stop); }
TEST_P(FirstDay, brake) { stopped_by(&test::ArmScript::brakes_closed, DriveMode::braked); }

TEST_P(FirstDay, lost_set_points_stop_softly_and_are_taken_up_again) {
  auto s = stage();
  s->start();
  ASSERT_EQ(s->bench.go_to(ControllerBench::arm(1.2, 0.4, -0.5), 1), "");
  s->run(1.2);
  s->wire_holds = false;
  s->run(0.06);
  EXPECT_EQ(s->state.mode, DriveMode::protective_stop);
  s->run(2.0);
  s->wire_holds = true;
  s->run(3.0);
  EXPECT_EQ(s->state.mode, DriveMode::enabled) << s->driver().reason();
  EXPECT_EQ(s->violations(), 0);
}

TEST_P(FirstDay, the_load_is_told_after_a_grasp) {
  auto s = stage();
  s->start();
  EXPECT_EQ(s->told_load(0.4), 0.4);
}

INSTANTIATE_TEST_SUITE_P(drivers, FirstDay, testing::Values(&make<CyclicStage>, &make<ReflexStage>),
                         [](const auto& p) { return std::string(p.index == 0 ? "position_arm" : "reflex_arm"); });

TEST(PositionArm, single_lost_messages_are_ridden_out_and_more_stop) {
  CyclicStage s({}, false);
  s.start();
  ASSERT_EQ(s.bench.go_to(ControllerBench::arm(1.2, 0.4, -0.5), 1), "");
  s.run(1.0);
  s.fake.lose = 2;
  s.run(0.1);
  EXPECT_EQ(s.state.mode, DriveMode::enabled);
  EXPECT_EQ(s.fake.violations, 0) << s.fake.last_violation;
  s.fake.lose = 20;
  s.run(0.06);
  EXPECT_EQ(s.state.mode, DriveMode::protective_stop);
  s.run(4.0);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << s.arm.core().reason();
  EXPECT_EQ(s.fake.violations, 0) << s.fake.last_violation;
}

TEST(PositionArm, a_set_point_that_jumps_never_reaches_the_arm) {
  CyclicStage s({}, false);
  s.start();
  JointCommand c;
  c.position = s.bench.core.set_point().position;
  c.velocity = c.acceleration = Vector::Zero(7);
  c.position[1] += 0.2;
  EXPECT_FALSE(s.arm.command(c, to_seconds(s.bench.now.time_since_epoch())));
  EXPECT_EQ(s.arm.core().refused(), 1u);
  s.run(0.1);
  EXPECT_EQ(s.fake.violations, 0);
}

TEST(ReflexArm, a_reflex_is_recovered_once_the_set_points_stand_where_the_arm_stands) {
  ReflexStage s({}, false);
  s.start();
  ASSERT_EQ(s.bench.go_to(ControllerBench::arm(1.2, 0.4, -0.5), 1), "");
  s.run(1.2);
  s.fake.push = 30.0;
  s.run(0.05);
  s.fake.push = 0.0;
  EXPECT_EQ(s.state.mode, DriveMode::protective_stop);
  EXPECT_NE(s.arm.core().reason().find("push"), std::string::npos);
  s.run(3.0);
  EXPECT_EQ(s.fake.recoveries, 1);
  EXPECT_EQ(s.state.mode, DriveMode::enabled) << s.arm.core().reason();
  EXPECT_EQ(s.bench.core.mode(), Mode::hold);
  ++s.bench.go.epoch;
  s.run(0.3);
  ASSERT_EQ(s.bench.go_to(ControllerBench::arm(0.2, 0.1, -0.2), 2), "");
  s.run(5.0);
  EXPECT_EQ(s.bench.core.status().motion, MotionState::finished);
  EXPECT_EQ(s.fake.violations, 0) << s.fake.error;
}

TEST(ReflexArm, after_some_recoveries_only_a_person_helps) {
  ReflexStage s({}, false);
  s.start();
  for (int k = 0; k < 5; ++k) {
    s.fake.push = 30.0;
    s.run(0.05);
    s.fake.push = 0.0;
    s.run(2.0);
  }
  EXPECT_EQ(s.fake.recoveries, 3);
  EXPECT_EQ(s.state.mode, DriveMode::protective_stop);
  s.arm.acknowledge();
  s.run(2.0);
  EXPECT_EQ(s.state.mode, DriveMode::enabled);
}

TEST(ReflexArm, velocity_limits_shrink_toward_the_ends_and_are_kept_by_stopping_before) {
  EXPECT_DOUBLE_EQ(drivers::velocity_toward_end(0.0, 2.0, 0.5, 3.0), 0.5);
  EXPECT_NEAR(drivers::velocity_toward_end(1.99, 2.0, 0.5, 3.0), std::sqrt(0.06), 1e-12);
  EXPECT_EQ(drivers::velocity_toward_end(2.1, 2.0, 0.5, 3.0), 0.0);
  ReflexStage s({}, false);
  s.start();
  // A motion to the very end of the joint: faster there than the arm allows, if its limits shrink early.
  ReflexStage slow({}, false);
  slow.start();
  ASSERT_EQ(slow.bench.go_to(ControllerBench::arm(0.0, 1.99, 0.0), 1), "");
  slow.run(8.0);
  EXPECT_EQ(slow.fake.violations, 0) << slow.fake.error;
  JointCommand c;
  c.position = Vector::Zero(7);
  c.velocity = c.acceleration = Vector::Zero(7);
  c.position[0] = 2.895;
  c.velocity[0] = 0.5;
  EXPECT_FALSE(s.arm.command(c, to_seconds(s.bench.now.time_since_epoch())));
  EXPECT_NE(s.arm.core().reason().find("shoulder_turn"), std::string::npos) << s.arm.core().reason();
  s.run(0.2);
  EXPECT_EQ(s.fake.violations, 0) << s.fake.error;
}

TEST(ReflexArm, the_gripper_closes_with_a_force_that_grows_with_the_squeeze_and_opens_by_width) {
  ReflexStage s({}, false);
  s.fake.object = 0.05;
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
  EXPECT_GT(s.fake.grasps, 0);
  EXPECT_NEAR(s.fake.width(), 0.05, 1e-3);
  EXPECT_GE(s.fake.force, 5.0);
  EXPECT_LE(s.fake.force, 40.0);
  c.id = 6;
  c.action = HandAction::release;
  c.position << 0.0, 0.0;
  ASSERT_EQ(s.bench.core.accept(c, Duration(0), s.bench.now), "");
  s.run(3.0);
  EXPECT_NEAR(s.fake.width(), 0.08, 1e-3);
  EXPECT_EQ(s.bench.core.status().hand, HandState::released);
}

}  // namespace
}  // namespace handsel
