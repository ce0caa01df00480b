// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/go_gate.hpp"

#include <gtest/gtest.h>

#include "components/trajectory_controller/supervise/mode_machine.hpp"

namespace handsel::trajectory_controller::go_gate_test {
namespace {

Go go(std::uint64_t epoch, std::uint64_t revision, bool allowed = true) {
  Go g;
  g.epoch = epoch;
  g.state_revision = revision;
  g.allowed = allowed;
  return g;
}

TEST(GoGate, the_first_go_heard_is_the_one_to_exceed) {
  GoGate gate;
  EXPECT_GT(gate.first_epoch(), 1'000'000u);
  EXPECT_EQ(gate.receive(go(5, 1)), GoRefusal::none);
  EXPECT_EQ(gate.first_epoch(), 5u);
  EXPECT_EQ(gate.receive(go(6, 1)), GoRefusal::none);
  EXPECT_EQ(gate.first_epoch(), 5u);
  EXPECT_TRUE(gate.allowed());
}

TEST(GoGate, a_go_from_no_state_or_an_older_one_withdraws_the_permission) {
  GoGate gate;
  gate.receive(go(5, 9));
  ASSERT_TRUE(gate.allowed());
  EXPECT_EQ(gate.receive(go(6, 0)), GoRefusal::no_state);
  EXPECT_FALSE(gate.allowed());
  gate.receive(go(6, 9));
  ASSERT_TRUE(gate.allowed());
  EXPECT_EQ(gate.receive(go(7, 8)), GoRefusal::older_state);
  EXPECT_FALSE(gate.allowed());
  EXPECT_TRUE(gate.awaits_person());
  EXPECT_EQ(gate.receive(go(8, 10)), GoRefusal::none);
  EXPECT_TRUE(gate.allowed());
}

TEST(GoGate, an_older_epoch_changes_nothing) {
  GoGate gate;
  gate.receive(go(5, 1));
  EXPECT_EQ(gate.receive(go(4, 1, false)), GoRefusal::older_epoch);
  EXPECT_TRUE(gate.allowed());
}

TEST(GoGate, a_stop_that_the_supervisor_has_missed_waits_for_a_person_too) {
  GoGate gate;
  gate.receive(go(5, 3));
  gate.receive(DriveMode::user_stop);
  gate.receive(DriveMode::enabled);
  gate.receive(go(6, 3));
  EXPECT_FALSE(gate.allowed()) << "the supervisor was dead when somebody pressed the stop";
  EXPECT_TRUE(gate.awaits_person());
  gate.receive(go(7, 4));
  EXPECT_TRUE(gate.allowed()) << "a person has resumed: a new state";
  gate.receive(DriveMode::braked);
  EXPECT_TRUE(gate.allowed());
}

TEST(GoGate, a_stop_seen_before_any_go_waits_for_a_newer_state_than_the_first) {
  GoGate gate;
  gate.receive(DriveMode::protective_stop);
  gate.receive(go(5, 3));
  EXPECT_FALSE(gate.allowed());
  gate.receive(go(6, 4));
  EXPECT_TRUE(gate.allowed());
}

TEST(GoGate, says_who_is_waited_for) {
  GoGate gate;
  gate.receive(go(5, 3, false));
  EXPECT_FALSE(gate.awaits_person());
  SafetyState paused;
  paused.paused = true;
  gate.receive(paused);
  EXPECT_TRUE(gate.awaits_person());
}

TEST(GoGate, moves_only_for_a_go_newer_than_the_first_one_heard) {
  ModeMachine machine({});
  ModeInputs in;
  in.robot_age = in.human_age = in.forecast_age = in.attention_age = in.go_age = 0.001;
  in.drive_enabled = in.at_rest = in.go_allowed = true;
  in.go_epoch = in.first_go_epoch = 5;
  for (int k = 0; k < 10; ++k)
    EXPECT_EQ(machine.update(in).mode, Mode::hold) << "it may be from before the start";
  in.go_epoch = 6;
  EXPECT_EQ(machine.update(in).mode, Mode::normal);
  in.go_allowed = false;
  in.awaits_person = true;
  EXPECT_EQ(machine.update(in).causes, bit(Cause::awaits_person));
  in.awaits_person = false;
  EXPECT_EQ(machine.update(in).causes, bit(Cause::no_go));
}

}  // namespace
}  // namespace handsel::trajectory_controller::go_gate_test
