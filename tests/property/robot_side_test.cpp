// SPDX-License-Identifier: Apache-2.0
// For any set-points, the reference of the robot side's servos stays within the limits, evaluated
// by finite differences of the positions alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "common/robot_side/robot_side.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "deploy/drivers/driver_core.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::robot_side_test {
namespace {

constexpr double kStep = 0.001;

const RobotModel& robot() {
  static const std::shared_ptr<const RobotModel> model = test::small_robot();
  return *model;
}

RobotSideSettings checked() {
  RobotSideSettings settings;
  settings.period = kStep;
  return settings;
}

/// Finite differences of the last four positions, of the axes below `axes` against `room` times the
/// guard limits. Positions, velocities and accelerations of set-points may each use up their bounds
/// without belonging to one motion: of three such steps the third difference is at most 8/3 J h^3,
/// and the second A h^2 + 4/3 J h^3.
class Oracle {
 public:
  explicit Oracle(double room = 1.0, double jerk_room = 8.0 / 3, Eigen::Index axes = 100)
      : room_(room), jerk_room_(jerk_room), axes_(axes) {}
  /// `slack`: duration of the extrapolation that a set-point corrects [s]; restarts the
  /// differences.
  void see(const Vector& position, double slack = 0) {
    for (int k = 3; k > 0; --k) last_[k] = last_[k - 1];
    last_[0] = position;
    count_ = std::min(count_ + 1, 4);
    const KinematicLimits& guard = robot().guard_limits();
    constexpr double h = kStep, kRounding = 1e-11;
    const double room = room_ * (1 + 1e-5), bound = room_ > 1 ? 1e-2 : 1e-5;
    for (Eigen::Index i = 0; i < std::min(axes_, position.size()); ++i) {
      const Axis& axis = robot().axes()[static_cast<std::size_t>(i)];
      const double V = guard.velocity[i] * room, A = guard.acceleration[i] * room,
                   J = guard.jerk[i] * room;
      EXPECT_GE(position[i], axis.lower - bound) << axis.name;
      EXPECT_LE(position[i], axis.upper + bound) << axis.name;
      const auto p = [&](int k) { return last_[k][i]; };
      if (count_ > 1) {
        EXPECT_LE(std::abs(p(0) - p(1)), V * (h + slack) + kRounding)
            << axis.name << " is too fast";
      }
      if (slack > 0) continue;
      if (count_ > 2) {
        EXPECT_LE(std::abs(p(0) - 2 * p(1) + p(2)), A * h * h + 4.0 / 3 * J * h * h * h + kRounding)
            << axis.name << " accelerates too fast";
      }
      if (count_ > 3) {
        EXPECT_LE(std::abs(p(0) - 3 * p(1) + 3 * p(2) - p(3)),
                  jerk_room_ * J * h * h * h + 10 * kRounding)
            << axis.name << " jerks";
      }
    }
    if (slack > 0) count_ = 1;
  }

 private:
  double room_, jerk_room_;
  Eigen::Index axes_;
  Vector last_[4];
  int count_{0};
};

/// A controller that moves between random configurations close to the guard limits while the robot
/// follows; else it rests at the measured configuration.
class Rightful {
 public:
  Rightful(std::mt19937_64& random, const Vector& start) : random_(random) {
    command_.robot = "small";
    rest(start);
  }
  const JointCommand& next(bool followed, const Vector& measured) {
    ++command_.sequence;
    if (!followed) {
      rest(measured);
      return command_;
    }
    if (motion_.axes.empty()) plan();
    time_ += kStep;
    const MotionState3 s = time_ < motion_.duration() ? motion_.at(time_) : rest_state(to_);
    command_.position = s.position;
    command_.velocity = s.velocity;
    command_.acceleration = s.acceleration;
    if (time_ >= motion_.duration()) motion_ = {};
    return command_;
  }

 private:
  void rest(const Vector& at) {
    command_.position = at;
    for (Eigen::Index i = 0; i < at.size(); ++i) {
      const Axis& axis = robot().axes()[static_cast<std::size_t>(i)];
      command_.position[i] = std::clamp(at[i], axis.lower, axis.upper);
    }
    command_.velocity = command_.acceleration = Vector::Zero(at.size());
    motion_ = {};
    time_ = 0;
  }
  void plan() {
    to_ = command_.position;
    for (Eigen::Index i = 0; i < to_.size(); ++i) {
      const Axis& axis = robot().axes()[static_cast<std::size_t>(i)];
      to_[i] = random_() % 4 == 0 ? (random_() % 2 ? axis.lower : axis.upper)
                                  : std::uniform_real_distribution(axis.lower, axis.upper)(random_);
    }
    const KinematicLimits& guard = robot().guard_limits();
    motion_ = solve(rest_state(command_.position), rest_state(to_),
                    {0.98 * guard.velocity, 0.98 * guard.acceleration, 0.98 * guard.jerk})
                  .trajectory;
    time_ = 0;
  }

  std::mt19937_64& random_;
  JointCommand command_;
  Trajectory motion_;
  Vector to_;
  double time_{0};
};

/// One of many kinds of wrong set-points, made of the rightful one.
JointCommand garbage(const JointCommand& rightful, std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  JointCommand c = rightful;
  const auto axis =
      static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(c.position.size()));
  const double sizes[] = {1e-9, 1e-6, 1e-4, 1e-2, 1.0, 1e3, 1e300};
  const double size = sizes[random() % std::size(sizes)] * (random() % 2 ? 1 : -1);
  switch (random() % 12) {
    case 0:
      c.position[axis] += size;
      break;
    case 1:
      c.velocity[axis] += size;
      break;
    case 2:
      c.acceleration[axis] += size;
      break;
    case 3:
      for (Vector* v : {&c.position, &c.velocity, &c.acceleration})
        for (Eigen::Index i = 0; i < v->size(); ++i) (*v)[i] = uniform(-5, 5);
      break;
    case 4:
      c.position[axis] = std::numeric_limits<double>::quiet_NaN();
      break;
    case 5:
      c.velocity[axis] = std::numeric_limits<double>::infinity();
      break;
    case 6:
      c.sequence += random() % 200;
      break;
    case 7:
      c.sequence = random();
      break;
    case 8:
      c.velocity = -c.velocity;
      break;
    case 9:
      c.position.array() += 1.0;
      c.velocity.setZero();
      c.acceleration.setZero();
      break;
    case 10:
      c.position.resize(static_cast<Eigen::Index>(random() % 9));
      c.position.setZero();
      break;
    default:
      c.velocity.setZero();
      c.acceleration.setZero();
      break;
  }
  return c;
}

struct Outcome {
  std::uint64_t followed{}, refused{}, resumed{};
};

/// A rightful stream with garbage between its set-points.
Outcome play(std::uint64_t seed, double garbage_rate, double loss, int steps) {
  std::mt19937_64 random(seed);
  const auto chance = [&](double p) {
    return std::uniform_real_distribution(0.0, 1.0)(random) < p;
  };
  const Vector start = Vector::Zero(robot().dof());
  RobotSide side(robot(), start, checked());
  Rightful rightful(random, start);
  // Only random set-points: each accepted one may reach its bounds against the preceding one, which
  // gives 11/3 J h^3 over three steps; after a missing one the error is up to 4/3 J h^3 larger,
  // which the third difference counts three times.
  Oracle oracle(1.0, garbage_rate < 1 ? 8.0 / 3 : 23.0 / 3);
  Outcome out;
  int accepted_before = 1;
  std::uint64_t number = 0;  // of the last accepted set-point
  for (int k = 0; k < steps && !testing::Test::HasFailure(); ++k) {
    const double now = kStep * k;
    const bool followed = side.follows();
    const JointCommand& c = rightful.next(followed, side.position());
    int accepted = 0;
    bool in_turn = true;
    const auto give = [&](const JointCommand& set_point) {
      if (!side.command(set_point, now)) return false;
      ++accepted;
      in_turn = in_turn && set_point.sequence == number + 1;
      number = set_point.sequence;
      return true;
    };
    if (chance(garbage_rate)) give(garbage(c, random));
    if (!chance(loss)) out.followed += give(c);
    if (chance(garbage_rate)) give(garbage(c, random));
    side.step(now, kStep);
    out.resumed += side.follows() && !followed;
    // After jumps of the number or missing set-points, a step may reach the bounds of several
    // periods.
    const bool regular = accepted == 0 || (accepted == 1 && accepted_before == 1 && in_turn) ||
                         (accepted == 1 && !followed);
    oracle.see(side.position(), regular ? 0.0 : 0.04);
    accepted_before = accepted;
  }
  out.refused = side.refused();
  return out;
}

TEST(RobotSideGate, a_rightful_stream_is_followed_without_a_refusal) {
  const std::uint64_t seed = std::random_device{}();
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  const Outcome out = play(seed, 0, 0, 60000);
  EXPECT_EQ(out.refused, 0u);
  EXPECT_GE(out.followed, 59900u)
      << "all but the first ones, which must rest at the robot's posture";
}

TEST(RobotSideGate, no_garbage_between_set_points_makes_a_motion_outside_the_limits) {
  for (int round = 0; round < 20; ++round) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Outcome out = play(seed, round % 2 ? 0.01 : 0.001, 0, 20000);
    EXPECT_GT(out.refused, 0u);
    EXPECT_GT(out.resumed, 0u) << "it follows again";
    EXPECT_GT(out.followed, 1000u);
    if (HasFailure()) std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  }
}

TEST(RobotSideGate, nothing_but_garbage_moves_nothing_beyond_the_limits) {
  for (int round = 0; round < 20; ++round) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    play(seed, 1.0, round % 2 ? 0.9 : 0.0, 5000);
    if (HasFailure()) std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  }
}

/// Set-points rest first at one place, then just where the reference passes on its path to another.
TEST(RobotSideGate, set_points_that_rest_where_the_reference_passes_stop_it_within_the_limits) {
  RobotSide side(robot(), Vector::Zero(robot().dof()), checked());
  side.hold(Vector::Zero(robot().dof()), DriveMode::enabled);
  Oracle oracle;
  JointCommand command;
  command.robot = "small";
  command.position = Vector::Constant(robot().dof(), 0.01);
  command.velocity = command.acceleration = Vector::Zero(robot().dof());
  bool passed = false;
  for (int k = 0; k < 2000; ++k) {
    passed = passed || side.position()[0] > 0.004;
    if (passed) command.position = side.position();
    ++command.sequence;
    side.command(command, kStep * k);
    side.step(kStep * k, kStep);
    oracle.see(side.position());
  }
  EXPECT_TRUE(passed);
  EXPECT_TRUE(side.follows());
}

TEST(RobotSideGate, lost_set_points_are_ridden_out_within_the_limits) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Outcome out = play(seed, 0, 0.3, 20000);
    EXPECT_EQ(out.refused, 0u);
    if (HasFailure()) std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  }
}

/// The output of a driver is smooth also for late or early set-points: differences fade with a
/// tenth of the limits.
TEST(DriverGate, no_garbage_makes_references_outside_the_limits) {
  constexpr double kFade = 0.1;
  for (int round = 0; round < 30; ++round) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const auto chance = [&](double p) {
      return std::uniform_real_distribution(0.0, 1.0)(random) < p;
    };
    drivers::DriverSettings settings;
    settings.watch = checked();
    settings.fade_fraction = kFade;
    drivers::DriverCore core(robot(), {0, 1, 2}, settings);
    drivers::Measured measured;
    measured.position = measured.velocity = measured.effort = measured.external_torque =
        Vector::Zero(robot().dof());
    measured.mode = DriveMode::enabled;
    Rightful rightful(random, measured.position);
    // After missing set-points, at most 20, the acceleration jumps by what the jerk would have
    // changed in that time.
    Oracle oracle(1 + kFade, 20 + 8.0 / 3, 3);
    std::uint64_t followed = 0;
    for (int k = 0; k < 20000 && !HasFailure(); ++k) {
      const double now = kStep * k;
      const JointCommand& c = rightful.next(core.following(), measured.position);
      if (chance(0.002)) core.command(garbage(c, random), now);
      if (!chance(0.05)) followed += core.command(c, now);
      core.update(measured, now, kStep);
      measured.position = core.reference();
      oracle.see(core.reference());
    }
    EXPECT_GT(followed, 1000u) << core.trouble();
    EXPECT_GT(core.refused(), 0u);
    if (HasFailure()) std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  }
}

class Refusals : public testing::Test {
 protected:
  Refusals() {
    command_.robot = "small";
    command_.position = command_.velocity = command_.acceleration = Vector::Zero(robot().dof());
    for (int k = 0; k < 100; ++k) tick();
    EXPECT_EQ(side_.refused(), 0u);
  }
  bool tick() {
    ++command_.sequence;
    now_ += kStep;
    const bool followed = side_.command(command_, now_);
    side_.step(now_, kStep);
    return followed;
  }
  JointCommand command_;
  RobotSide side_{robot(), Vector::Zero(robot().dof()), checked()};
  double now_{0};
};

TEST_F(Refusals, name_the_axis_and_the_limit_and_count) {
  command_.velocity[1] = 1.1 * robot().guard_limits().velocity[1];
  EXPECT_FALSE(tick());
  EXPECT_EQ(side_.refused(), 1u);
  EXPECT_NE(side_.refusal().find("refused a set-point: velocity of axis shoulder is"),
            std::string::npos)
      << side_.refusal();
  EXPECT_EQ(side_.mode(), DriveMode::enabled);
  EXPECT_FALSE(side_.follows());
  command_.velocity[1] = 0;
  for (int k = 0; k < 20; ++k) tick();
  EXPECT_TRUE(side_.follows()) << "set-points rest at the posture again";
  EXPECT_EQ(side_.refusal(), "");
  EXPECT_EQ(side_.refused(), 1u);
}

TEST_F(Refusals, a_jump_that_no_jerk_explains_is_refused) {
  command_.position[0] += 1e-6;
  EXPECT_FALSE(tick());
  EXPECT_NE(side_.refusal().find("position step of axis shoulder_turn"), std::string::npos)
      << side_.refusal();
}

TEST_F(Refusals, a_set_point_with_an_old_number_is_refused_without_a_stop) {
  command_.sequence -= 5;
  EXPECT_FALSE(tick());
  EXPECT_EQ(side_.refused(), 1u);
  EXPECT_TRUE(side_.follows());
  command_.sequence += 5;
  EXPECT_TRUE(tick());
}

TEST_F(Refusals, set_points_that_run_ahead_of_their_time_are_refused) {
  const auto before = side_.refused();
  for (int k = 0; k < 100 && side_.refused() == before; ++k) {
    command_.sequence += 4;
    now_ += 0;
    tick();
  }
  EXPECT_NE(side_.refusal().find("time ahead"), std::string::npos) << side_.refusal();
}

TEST_F(Refusals, a_motion_too_fast_to_stop_before_a_bound_is_refused_before_it) {
  const double A = 0.5 * robot().guard_limits().acceleration[2],
               J = 0.5 * robot().guard_limits().jerk[2];
  const double V = 0.99 * robot().guard_limits().velocity[2], upper = robot().axes()[2].upper;
  AxisProfile profile;
  critical_movement({}, {V, 0}, A, J, profile);
  double t = 0, highest = 0;
  for (int k = 0; k < 20000 && side_.refused() == 0; ++k) {
    t += kStep;
    AxisState s{};
    double left = t;
    for (int i = 0; i < profile.count && left > 0; ++i) {
      const double part = std::min(left, profile.segments[static_cast<std::size_t>(i)].duration);
      s = advanced(s, part, profile.segments[static_cast<std::size_t>(i)].jerk);
      left -= part;
    }
    if (left > 0) s = advanced({s.position, s.velocity, 0}, left, 0);
    command_.position[2] = s.position;
    command_.velocity[2] = s.velocity;
    command_.acceleration[2] = left > 0 ? 0 : s.acceleration;
    tick();
  }
  EXPECT_EQ(side_.refused(), 1u);
  while (!side_.stopped()) {
    side_.step(now_ += kStep, kStep);
    highest = std::max(highest, side_.position()[2]);
  }
  EXPECT_LE(highest, upper + 1e-5);
  EXPECT_GT(highest, upper - 0.05);
}

}  // namespace
}  // namespace handsel::robot_side_test
