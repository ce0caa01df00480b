// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/mode_machine.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>

namespace handsel::trajectory_controller::mode_machine_test {
namespace {

ModeInputs well() {
  ModeInputs in;
  in.robot_age = in.human_age = in.forecast_age = in.attention_age = in.go_age = 0.001;
  in.drive_enabled = in.at_rest = in.go_allowed = true;
  in.go_epoch = 1;
  return in;
}

TEST(ModeMachine, begins_in_hold_and_needs_a_permission) {
  ModeMachine machine({});
  ModeInputs in = well();
  in.go_age = -1;
  in.go_allowed = false;
  in.go_epoch = 0;
  EXPECT_EQ(machine.update(in).mode, Mode::hold);
  EXPECT_EQ(machine.update(well()).mode, Mode::normal);
}

TEST(ModeMachine, the_gravest_cause_decides_and_all_are_named) {
  ModeMachine machine({});
  machine.update(well());
  ModeInputs in = well();
  in.attention_slow = in.cycle_late = in.separation_stop = in.tracking_error = true;
  const ModeVerdict v = machine.update(in);
  EXPECT_EQ(v.mode, Mode::fault);
  EXPECT_EQ(v.causes, bit(Cause::cycle_late) | bit(Cause::separation) | bit(Cause::tracking_error));
  EXPECT_EQ(worst_of(v.causes), Cause::tracking_error);
}

TEST(ModeMachine, a_silent_component_is_named_while_the_robot_holds) {
  ModeMachine machine({});
  machine.update(well());
  ModeInputs in = well();
  in.cycle_late = true;
  machine.update(in);
  in.cycle_late = false;
  in.attention_slow = true;
  in.attention_age = 10;
  const ModeVerdict v = machine.update(in);
  EXPECT_EQ(v.mode, Mode::hold);
  EXPECT_EQ(v.causes, bit(Cause::no_go) | bit(Cause::attention_silent));
}

TEST(ModeMachine, every_drive_mode_but_enabled_stops) {
  ModeMachine machine({});
  machine.update(well());
  ModeInputs in = well();
  in.drive_enabled = false;
  EXPECT_EQ(machine.update(in).mode, Mode::stop);
  in = well();
  EXPECT_EQ(machine.update(in).mode, Mode::hold) << "the cause is gone, the permission is old";
  EXPECT_EQ(machine.update(in).mode, Mode::hold);
  ++in.go_epoch;
  EXPECT_EQ(machine.update(in).mode, Mode::normal);
}

TEST(ModeMachine, a_stop_is_left_only_at_rest) {
  ModeMachine machine({});
  machine.update(well());
  ModeInputs in = well();
  in.separation_stop = true;
  in.at_rest = false;
  machine.update(in);
  in.separation_stop = false;
  ++in.go_epoch;
  EXPECT_EQ(machine.update(in).mode, Mode::stop);
  in.at_rest = true;
  EXPECT_EQ(machine.update(in).mode, Mode::hold);
}

TEST(ModeMachine, an_acknowledgement_must_be_newer_than_the_fault) {
  ModeMachine machine({});
  machine.update(well());
  ModeInputs in = well();
  in.go_acknowledge = true;
  in.limit_violation = true;
  machine.update(in);
  in.limit_violation = false;
  for (int k = 0; k < 10; ++k)
    EXPECT_EQ(machine.update(in).mode, Mode::fault) << "the same Go that stood when it happened";
  ++in.go_epoch;
  in.go_acknowledge = false;
  EXPECT_EQ(machine.update(in).mode, Mode::fault) << "a newer Go without a person's word";
  in.go_acknowledge = true;
  EXPECT_EQ(machine.update(in).mode, Mode::hold)
      << "through Stop, which nothing holds any more, to Hold";
  EXPECT_EQ(machine.update(in).mode, Mode::normal);
}

// For any inputs: the only path from Stop or Fault to Normal or Slow is through Hold, from Fault
// only by a person, and the mode is never less severe than a present cause requires.
TEST(ModeMachine, a_million_random_inputs_keep_the_rules) {
  const std::uint64_t seed = 99;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  const auto chance = [&](int one_in) {
    return random() % static_cast<std::uint64_t>(one_in) == 0;
  };
  ModeMachine machine({});
  ModeInputs in;
  Mode before = Mode::hold;
  int left[5] = {};
  bool robot_seen = false, go_seen = false;
  for (int k = 0; k < 1000000; ++k) {
    if (chance(20000)) {
      machine = ModeMachine({});
      before = Mode::hold;
      robot_seen = go_seen = false;
    }
    robot_seen = robot_seen || chance(5);
    go_seen = go_seen || chance(5);
    in = well();
    in.go_epoch = 1 + static_cast<std::uint64_t>(k) / 8;
    in.robot_age = !robot_seen ? -1 : chance(40) ? 0.05 : 0.001;
    in.human_age = chance(40) ? 0.5 : 0.01;
    in.forecast_age = chance(10) ? 0.5 : 0.01;
    in.attention_age = chance(10) ? -1 : 0.01;
    in.go_age = !go_seen ? -1 : chance(60) ? 0.5 : 0.01;
    in.running = chance(2);
    in.running_for = chance(2) ? 1.0 : 0.05;
    in.at_rest = !chance(3);
    in.drive_enabled = !chance(40);
    in.tracking_error = chance(200);
    in.limit_violation = chance(400);
    in.cycle_late = chance(40);
    in.forecast_collision_hold = chance(40);
    in.separation_slow = chance(4);
    in.wall_slow = chance(4);
    in.separation_stop = chance(60);
    in.contact_stop = chance(60);
    in.attention_slow = chance(4);
    in.go_allowed = go_seen && !chance(20);
    in.go_acknowledge = go_seen && chance(4);
    if (!go_seen) in.go_epoch = 0;
    const Mode now = machine.update(in).mode;
    if (before == Mode::fault && now != Mode::fault) {
      ASSERT_TRUE(in.go_acknowledge) << k;
      ++left[static_cast<int>(Mode::fault)];
    }
    if (before == Mode::stop && now < Mode::stop) ++left[static_cast<int>(Mode::stop)];
    ASSERT_TRUE(before < Mode::stop || now >= Mode::hold) << k;
    ASSERT_TRUE(now == Mode::fault || !(in.tracking_error || in.limit_violation)) << k;
    ASSERT_TRUE(now >= Mode::stop || in.drive_enabled || in.robot_age < 0) << k;
    ASSERT_TRUE(now >= Mode::hold || in.go_allowed) << k;
    ASSERT_TRUE(now >= Mode::slow || !(in.separation_slow || in.wall_slow)) << k;
    ASSERT_TRUE(now >= Mode::stop || !(in.separation_stop || in.contact_stop)) << k;
    before = now;
  }
  EXPECT_GT(left[static_cast<int>(Mode::fault)], 100);
  EXPECT_GT(left[static_cast<int>(Mode::stop)], 1000);
}

}  // namespace
}  // namespace handsel::trajectory_controller::mode_machine_test
