// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "common/model/human/two_bones.hpp"
#include "common/trajectory/stop.hpp"
#include "sim/oracle/handover_oracle.hpp"
#include "sim/oracle/limits_oracle.hpp"
#include "sim/oracle/taking_oracle.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::sim_oracle_test {
namespace {

using namespace test;

/// A legal stream: one axis back and forth by segments of constant jerk at 90 % of the guard
/// limits, exact at every tick.
class Stream {
 public:
  explicit Stream(double share = 0.9) : share_(share) {
    command_.robot = "jido";
    command_.position = jido().rest_configuration();
    command_.velocity = command_.acceleration = Vector::Zero(jido().dof());
  }
  const JointCommand& next() {
    const double J = share_ * jido().guard_limits().jerk[0],
                 A = share_ * jido().guard_limits().acceleration[0], h = 0.001;
    const int third = static_cast<int>(A / (J * h));
    const int phase = (tick_++ / third) % 4;
    const double j = phase == 0 || phase == 3 ? J : -J;
    command_.position[0] +=
        h * (command_.velocity[0] + h * (command_.acceleration[0] / 2 + h * j / 6));
    command_.velocity[0] += h * (command_.acceleration[0] + h * j / 2);
    command_.acceleration[0] += h * j;
    ++command_.sequence;
    return command_;
  }
  JointCommand& last() { return command_; }

 private:
  double share_;
  JointCommand command_;
  int tick_{0};
};

struct Judge {
  LimitsOracle oracle{jido(), 0.02};
  double now{0};
  void see(const JointCommand& c, std::uint64_t writer = 1) {
    oracle.observe(c, writer, now += 0.001, c.position);
  }
};

TEST(LimitsOracleTest, a_legal_stream_has_no_violation_and_its_true_shares) {
  Judge judge;
  Stream stream(0.9);
  for (int i = 0; i < 2000; ++i) judge.see(stream.next());
  EXPECT_EQ(judge.oracle.violations(), 0u) << judge.oracle.first_violation();
  EXPECT_NEAR(judge.oracle.ratio_jerk(), 0.9, 1e-6);
  EXPECT_NEAR(judge.oracle.ratio_acceleration(), 0.9, 1e-2);
  EXPECT_DOUBLE_EQ(judge.oracle.period(), 0.001);
  EXPECT_EQ(judge.oracle.count(), 2000u);
  EXPECT_EQ(judge.oracle.writers(), 1u);
}

TEST(LimitsOracleTest, late_set_points_are_no_violation) {
  Judge judge;
  Stream stream(0.99);
  for (int i = 0; i < 5000; ++i) {
    if (i == 90) judge.now += 0.018;  // delay of a busy machine
    judge.see(stream.next());
  }
  EXPECT_EQ(judge.oracle.violations(), 0u) << judge.oracle.first_violation();
  EXPECT_DOUBLE_EQ(judge.oracle.period(), 0.001);
}

TEST(LimitsOracleTest, left_out_cycles_and_a_clock_that_falls_behind_are_no_violation) {
  LimitsOracle oracle{jido(), 0.02};
  Stream stream(0.99);
  double simulated = 0.0;
  Stamp stamp = 1'000'000'000;
  for (int i = 0; i < 5000; ++i) {
    JointCommand c = stream.next();
    stamp += i % 9 == 4 ? 2'000'000 : 1'000'000;  // skips a cycle, but no sequence number
    simulated += i % 3 == 0 ? 0.0 : 0.001;
    c.stamp = stamp;
    oracle.observe(c, 1, simulated, c.position);
  }
  EXPECT_EQ(oracle.violations(), 0u) << oracle.first_violation();
  EXPECT_DOUBLE_EQ(oracle.period(), 0.001);
}

TEST(LimitsOracleTest, lost_set_points_are_no_violation) {
  Judge judge;
  Stream stream(0.99);
  for (int i = 0; i < 2000; ++i) {
    const JointCommand& c = stream.next();
    if (i % 7 == 3 || i % 11 == 5) {
      judge.now += 0.001;
    } else {
      judge.see(c);
    }
  }
  EXPECT_EQ(judge.oracle.violations(), 0u) << judge.oracle.first_violation();
  EXPECT_LE(judge.oracle.ratio_jerk(), 1 + 1e-6);
}

TEST(LimitsOracleTest, share_is_just_above_one_when_jerk_is) {
  Judge judge;
  Stream stream(1.0 + 1e-5);
  for (int i = 0; i < 200; ++i) judge.see(stream.next());
  EXPECT_GT(judge.oracle.violations(), 0u);
  EXPECT_NEAR(judge.oracle.ratio_jerk(), 1 + 1e-5, 2e-6);
}

using Break = std::function<void(JointCommand&)>;

std::string broken_by(const Break& mutate, int at = 500) {
  Judge judge;
  Stream stream(0.5);
  for (int i = 0; i < at; ++i) judge.see(stream.next());
  EXPECT_EQ(judge.oracle.violations(), 0u);
  JointCommand bad = stream.next();
  mutate(bad);
  judge.see(bad);
  return judge.oracle.violations() == 1 ? judge.oracle.first_violation() : "not caught";
}

TEST(LimitsOracleTest, every_mutant_is_caught_by_name) {
  const KinematicLimits& limits = jido().guard_limits();
  EXPECT_EQ(broken_by([](JointCommand& c) { c.position[0] += 1e-6; }).substr(0, 13),
            "position step");
  EXPECT_NE(broken_by([](JointCommand& c) { c.velocity[0] += 1e-3; }), "not caught");
  EXPECT_EQ(broken_by([&](JointCommand& c) {
              c.acceleration[2] = 1.01 * limits.jerk[2] * 0.001;
            }).substr(0, 4),
            "jerk");
  EXPECT_NE(broken_by([&](JointCommand& c) { c.acceleration[3] = 1.01 * limits.acceleration[3]; }),
            "not caught");
  EXPECT_NE(broken_by([&](JointCommand& c) { c.velocity[4] = -1.01 * limits.velocity[4]; }),
            "not caught");
  EXPECT_NE(broken_by([](JointCommand& c) { c.position[5] = 9; }), "not caught");
}

TEST(LimitsOracleTest, the_first_hundred_are_judged_too) {
  Judge judge;
  Stream stream(0.5);
  for (int i = 0; i < 300; ++i) {
    JointCommand c = stream.next();
    if (i == 20) c.position[1] += 1e-4;
    judge.see(c);
  }
  EXPECT_GT(judge.oracle.violations(), 0u);
}

/// A second stream takes over in the middle of a motion: `offset` away on one axis.
std::uint64_t violations_across(double offset, std::uint64_t writer, bool restarts_numbers,
                                int at) {
  Judge judge;
  Stream stream(0.5);
  for (int i = 0; i < at; ++i) judge.see(stream.next());
  EXPECT_EQ(judge.oracle.violations(), 0u) << judge.oracle.first_violation();
  for (int i = 0; i < 200; ++i) {
    JointCommand c = stream.next();
    c.position[1] += offset;
    if (restarts_numbers) c.sequence = static_cast<std::uint64_t>(i) + 1;
    judge.see(c, writer);
  }
  return judge.oracle.violations();
}

TEST(LimitsOracleTest, judges_the_step_from_one_writer_to_another) {
  EXPECT_EQ(violations_across(0, 2, false, 500), 0u) << "one that continues exactly is legal";
  EXPECT_EQ(violations_across(0, 2, true, 500), 0u);
  EXPECT_EQ(violations_across(0.01, 2, false, 500), 1u);
  EXPECT_EQ(violations_across(0.01, 2, true, 500), 1u);
  EXPECT_EQ(violations_across(0.01, 2, true, 50), 1u) << "also while the period is not known";
}

TEST(LimitsOracleTest, judges_the_step_to_a_sequence_number_that_has_not_grown) {
  EXPECT_EQ(violations_across(0, 1, true, 500), 0u);
  EXPECT_EQ(violations_across(0.01, 1, true, 500), 1u);
  EXPECT_EQ(violations_across(0.01, 1, true, 50), 1u);
}

TEST(LimitsOracleTest, judges_two_writers_that_alternate) {
  Judge judge;
  Stream stream(0.5);
  JointCommand rest = stream.last();
  rest.position[0] += 0.2;
  std::uint64_t number = 0;
  for (int i = 0; i < 400; ++i) {
    judge.see(stream.next(), 1);
    rest.sequence = ++number;
    judge.see(rest, 2);
  }
  EXPECT_GT(judge.oracle.violations(), 790u);
}

TEST(LimitsOracleTest, a_second_writer_and_a_long_gap_are_seen) {
  Judge judge;
  Stream stream(0.5);
  for (int i = 0; i < 300; ++i) judge.see(stream.next());
  judge.now += 0.5;
  judge.see(stream.next(), 2);
  EXPECT_EQ(judge.oracle.writers(), 2u);
  EXPECT_NEAR(judge.oracle.max_gap(), 0.501, 1e-9);
  EXPECT_EQ(judge.oracle.violations(), 0u) << "a new start at the robot's configuration is legal";
  judge.now += 0.5;
  JointCommand far = stream.next();
  const Vector actual = far.position;
  far.position[0] += 0.2;
  judge.oracle.observe(far, 2, judge.now, actual);
  EXPECT_EQ(judge.oracle.violations(), 1u) << "a new start elsewhere is a jump";
  judge.now += 0.5;
  far = stream.next();
  Vector bent = far.position;
  bent[0] += 0.2;
  judge.oracle.observe(far, 2, judge.now, bent, far.position);
  EXPECT_EQ(judge.oracle.violations(), 1u) << "a set-point that the servos hold moves nothing";
  judge.now += 0.5;
  judge.oracle.observe(stream.next(), 2, judge.now, bent, bent);
  EXPECT_EQ(judge.oracle.violations(), 2u);
}

TEST(SeparationOracleTest, its_stop_agrees_with_the_stop_of_the_trajectory_room) {
  std::mt19937_64 random(20240607);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 20000; ++i) {
    const double A = uniform(0.2, 10), J = uniform(1, 100), v = uniform(-3, 3), a = uniform(-A, A);
    double time = 0, distance = 0;
    SeparationOracle::stop_measure(v, a, A, J, time, distance);
    const StopMeasure other = measure_stop(v, a, A, J);
    ASSERT_NEAR(time, other.duration, 1e-9 * (1 + time))
        << "seed 20240607 case " << i << " v " << v << " a " << a << " A " << A << " J " << J;
    ASSERT_NEAR(distance, other.distance, 1e-9 * (1 + std::abs(distance))) << "case " << i;
  }
}

TEST(PeakSpeedTest, a_jump_within_one_step_is_no_motion) {
  PeakSpeed peak;
  for (int step = 0; step < 100; ++step) peak.add(step == 50 ? 65.0 : 0.4 + 0.001 * step);
  EXPECT_NEAR(peak.peak(), 0.4 + 0.001 * 97, 1e-12);
  for (int step = 0; step < 3; ++step) peak.add(1.5);
  EXPECT_DOUBLE_EQ(peak.peak(), 1.5);
}

TEST(SeparationOracleTest, approaching_fast_is_a_violation_standing_is_not) {
  config::Scenario scenario;
  scenario.set_name("near");
  auto* person = add_person(scenario, config::STILL);
  person->set_x(in_hand().x() + 0.45);
  SimWorld world(jido(), library(), scenario, SimSettings{}, 1);
  Driver driver(world, jido().rest_configuration());
  driver.hold(0.5);
  EXPECT_EQ(truth_of(world).ssm_violations, 0u);
  const Group& arm = jido().require_group("arm");
  Pose T = jido().link_pose(driver.q(), arm.tip);
  T.translation().x() += 0.1;
  const auto nearer = jido().inverse(arm, T, driver.q());
  ASSERT_TRUE(nearer.has_value());
  const double before = truth_of(world).separation;
  driver.move(RobotModel::with(driver.q(), arm, *nearer), 0.25);
  EXPECT_LT(truth_of(world).separation, before);
  EXPECT_GT(truth_of(world).ssm_violations, 0u);
}

TEST(TakingOracleTest, the_arm_of_the_hand_that_takes_is_measured_at_the_release) {
  const ObjectModel& mug = *library()("mug");
  // Anna faces -x, her left is at -y. Her hand is on her side of the mug, in front of the shoulder
  // and `below` it [m].
  const auto taken = [&](Side side, double below) {
    const bool is_left = side == Side::left;
    Person anna;
    anna.joints = standing_body({1.5, 0, 0}, M_PI, 1.75);
    const auto joint = [&](const std::string& name) -> Vector3& {
      return anna.joints[static_cast<std::size_t>(body_joint_index((is_left ? "l_" : "r_") + name))]
          .position;
    };
    const Vector3 shoulder = joint("shoulder");
    const double upper = (joint("elbow") - shoulder).norm(),
                 fore = (joint("wrist") - joint("elbow")).norm(),
                 palm = (joint("hand") - joint("wrist")).norm();
    joint("hand") = shoulder + Vector3(-0.35, 0, -below);
    joint("wrist") = joint("hand") + palm * (shoulder - joint("hand")).normalized();
    joint("elbow") = bend(shoulder, joint("wrist"), upper, fore, shoulder - Vector3::UnitZ());
    const Pose T_world_mug = make_pose(joint("hand") - Vector3(0.07, 0, 0) - mug.com);
    const Taker taker{&anna, side, &mug, T_world_mug,
                      T_world_mug.translation() - Vector3(0.15, 0, 0)};
    TakingOracle oracle;
    GroundTruth truth;
    oracle.observe(true, taker);
    oracle.observe(true, taker);
    oracle.write(truth);
    EXPECT_FALSE(truth.taken) << "the robot has it still";
    oracle.observe(false, taker);
    oracle.observe(false, std::nullopt);
    oracle.write(truth);
    EXPECT_TRUE(truth.taken);
    EXPECT_EQ(truth.taking_side, side);
    return truth;
  };
  const GroundTruth right = taken(Side::right, 0.3), left = taken(Side::left, 0.3),
                    high = taken(Side::left, -0.15);
  const auto strain = [](const GroundTruth& t) {
    return std::max(t.taking_wrist_strain, t.taking_arm_strain);
  };
  EXPECT_GT(strain(right), 0);
  EXPECT_LT(strain(right), 0.9);
  EXPECT_LT(right.taking_arm_strain, right.taking_wrist_strain - 0.03) << "the upper arm hangs";
  EXPECT_NEAR(strain(right), strain(left), 0.1);
  EXPECT_GT(high.taking_arm_strain, left.taking_arm_strain + 0.1);
  EXPECT_GT(strain(high), strain(left) + 0.1);
  TakingOracle put_down;
  put_down.observe(true, std::nullopt);
  put_down.observe(false, std::nullopt);
  GroundTruth truth;
  put_down.write(truth);
  EXPECT_FALSE(truth.taken);
}

TEST(HandoverOracleTest, demands_lift_contact_and_a_second_alone) {
  const auto run = [](double lift, double contact, double alone, bool floor) {
    HandoverOracle oracle(0.8, false);
    const auto pass = [&](const ObjectSituation& s, double seconds) {
      for (int i = 0; i < static_cast<int>(std::lround(seconds * 1000)); ++i)
        oracle.observe(s, 0.001);
    };
    ObjectSituation s;
    s.height = 0.8, s.on_surface = true;
    pass(s, 0.1);
    s = {}, s.height = 0.8 + lift, s.robot_grips = s.robot_touches = true;
    pass(s, 1.0);
    s.human_touches = s.human_grips = true;
    pass(s, contact);
    s.robot_grips = s.robot_touches = false, s.on_floor = floor;
    pass(s, alone);
    GroundTruth ground_truth;
    oracle.write(ground_truth);
    return ground_truth.handover_done;
  };
  EXPECT_TRUE(run(0.12, 0.3, 1.0, false));
  EXPECT_FALSE(run(0.09, 0.3, 1.0, false));
  EXPECT_FALSE(run(0.12, 0.19, 1.0, false));
  EXPECT_FALSE(run(0.12, 0.3, 0.9, false));
  EXPECT_FALSE(run(0.12, 0.3, 1.0, true));
}

TEST(HandoverOracleTest, what_a_person_gives_must_be_in_both_hands_then_in_the_robots_alone) {
  const auto run = [](double both, double alone, bool floor) {
    HandoverOracle oracle(1.0, true);
    const auto pass = [&](const ObjectSituation& s, double seconds) {
      for (int i = 0; i < static_cast<int>(std::lround(seconds * 1000)); ++i)
        oracle.observe(s, 0.001);
    };
    ObjectSituation s;
    s.height = 1.0, s.human_grips = s.human_touches = true;
    pass(s, 1.0);
    EXPECT_FALSE(oracle.shared());
    s.robot_grips = s.robot_touches = true;
    pass(s, both);
    EXPECT_TRUE(oracle.shared());
    s.human_grips = s.human_touches = false, s.on_floor = floor;
    pass(s, alone);
    GroundTruth ground_truth;
    oracle.write(ground_truth);
    return ground_truth.handover_done;
  };
  EXPECT_TRUE(run(0.3, 1.0, false));
  EXPECT_FALSE(run(0.1, 1.0, false)) << "hardly shared";
  EXPECT_FALSE(run(0.3, 0.9, false));
  EXPECT_FALSE(run(0.3, 1.0, true)) << "dropped";
}

TEST(HandoverOracleTest, counts_what_goes_back_and_forth) {
  HandoverOracle oracle(0.8, false);
  const auto pass = [&](const ObjectSituation& s, double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 1000)); ++i)
      oracle.observe(s, 0.001);
    GroundTruth ground_truth;
    oracle.write(ground_truth);
    return ground_truth.handovers;
  };
  ObjectSituation table, robot, both, person;
  table.height = 0.8, table.on_surface = true;
  robot.height = both.height = person.height = 1.0;
  robot.robot_grips = robot.robot_touches = both.robot_grips = both.robot_touches = true;
  person.human_grips = person.human_touches = both.human_grips = both.human_touches = true;
  pass(table, 1.0);
  for (std::uint64_t round = 0; round < 3; ++round) {
    EXPECT_EQ(pass(robot, 2.0), 2 * round);
    EXPECT_EQ(pass(both, 0.3), 2 * round);
    EXPECT_EQ(pass(person, 1.5), 2 * round + 1) << "given";
    EXPECT_FALSE(oracle.shared());
    EXPECT_EQ(pass(both, 0.3), 2 * round + 1);
    EXPECT_EQ(pass(robot, 1.5), 2 * round + 2) << "taken";
    EXPECT_EQ(pass(table, 1.0), 2 * round + 2);
  }
  pass(robot, 2.0);
  EXPECT_EQ(pass(person, 1.5), 6U) << "never in both hands";
  pass(both, 0.3);
  EXPECT_EQ(pass(robot, 1.5), 7U) << "taken from the person, however the person got it";
}

}  // namespace
}  // namespace handsel::sim::sim_oracle_test
