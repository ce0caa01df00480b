// SPDX-License-Identifier: Apache-2.0
// Alive, starved or hung: the launcher's conclusion from heartbeats and kernel data.
#include "deploy/handsel/system/liveness.hpp"

#include <gtest/gtest.h>

namespace handsel::liveness_test {
namespace {

/// A process whose signs of life are set by hand.
struct Process {
  LifeSigns signs{.now = TimePoint(from_seconds(100.0))};
  Liveness liveness{LivenessSettings{}, signs};
  bool beats{true}, job_silent{};

  /// Runs for `seconds` with ten checks per second; in each second the process waits `waiting` and
  /// the listener `deaf` for a processor [s].
  Life live(double seconds, double waiting = 0.0, double deaf = 0.0) {
    Life life{};
    for (int k = 0; k < static_cast<int>(10 * seconds + 0.5); ++k) {
      signs.now += from_seconds(0.1);
      signs.main_delay += from_seconds(0.1 * waiting);
      signs.total_delay += from_seconds(0.1 * waiting);
      signs.own_delay += from_seconds(0.1 * deaf);
      if (beats) liveness.beat(signs.now, job_silent);
      life = liveness.assess(signs);
      if (life == Life::hung) return life;
    }
    return life;
  }
  double since(TimePoint begin) const { return to_seconds(signs.now - begin); }
};

TEST(Liveness, a_process_with_heartbeats_is_alive) {
  Process p;
  EXPECT_EQ(p.live(60), Life::alive);
}

TEST(Liveness, a_stopped_process_is_hung_after_two_seconds) {
  Process p;
  p.live(5);
  const TimePoint stopped = p.signs.now;
  p.beats = false;
  p.signs.state = 'T';
  EXPECT_EQ(p.live(10), Life::hung);
  EXPECT_NEAR(p.since(stopped), 2.0, 0.15);
}

TEST(Liveness, a_process_that_waits_for_something_that_never_comes_is_hung) {
  Process p;
  p.live(5);
  p.beats = false;
  EXPECT_EQ(p.live(1.9), Life::alive);
  EXPECT_EQ(p.live(0.3), Life::hung);
}

TEST(Liveness, one_that_spins_on_a_busy_machine_is_hung_once_it_has_had_its_time) {
  Process p;
  p.live(5);
  p.beats = false;
  p.signs.state = 'R';
  const TimePoint begin = p.signs.now;
  EXPECT_EQ(p.live(10, 0.5), Life::hung);
  EXPECT_NEAR(p.since(begin), 4.0, 0.2);
}

TEST(Liveness, a_process_that_waits_for_a_processor_is_starved_and_never_hung) {
  Process p;
  p.live(5);
  p.beats = false;
  p.signs.state = 'R';
  EXPECT_EQ(p.live(600, 1.0), Life::starved);
  p.beats = true;
  EXPECT_EQ(p.live(1), Life::alive);
}

TEST(Liveness, what_a_starved_listener_has_not_heard_is_nobodys_fault) {
  for (const char state : {'S', 'R'}) {
    Process p;
    p.live(5);
    p.beats = false;
    p.signs.state = state;
    EXPECT_EQ(p.live(60, 0.0, 1.0), Life::starved) << state;
  }
}

TEST(Liveness, a_stopped_process_is_seen_without_listening) {
  Process p;
  p.live(5);
  p.beats = false;
  p.signs.state = 'R';
  EXPECT_EQ(p.live(3, 1.0), Life::starved);
  p.signs.state = 'T';
  EXPECT_EQ(p.live(1.9, 0.0, 1.0), Life::starved) << "it may go on in a moment";
  EXPECT_EQ(p.live(0.3, 0.0, 1.0), Life::hung);
}

TEST(Liveness, short_stops_do_not_add_up) {
  Process p;
  p.live(1);
  for (int k = 0; k < 10; ++k) {
    p.beats = false;
    p.signs.state = 'T';
    EXPECT_EQ(p.live(1.5), Life::alive);
    p.beats = true;
    p.signs.state = 'S';
    EXPECT_EQ(p.live(0.2), Life::alive);
  }
}

TEST(Liveness, what_a_debugger_or_a_device_keeps_is_not_hung) {
  for (const char state : {'t', 'D'}) {
    Process p;
    p.live(5);
    p.beats = false;
    p.signs.state = state;
    EXPECT_EQ(p.live(60), Life::starved) << state;
  }
}

TEST(Liveness, a_start_may_take_longer_than_a_silence) {
  Process p;
  p.beats = false;
  EXPECT_EQ(p.live(15), Life::starting);
  EXPECT_EQ(p.live(10), Life::hung);
  Process slow;
  slow.beats = false;
  slow.signs.state = 'R';
  EXPECT_EQ(slow.live(60, 0.9), Life::starting) << "it has had six seconds of processor time";
  Process stopped;
  stopped.beats = false;
  stopped.signs.state = 'T';
  EXPECT_EQ(stopped.live(2.2), Life::hung);
}

TEST(Liveness, a_silent_job_is_hung_after_a_longer_time) {
  Process p;
  p.live(5);
  p.job_silent = true;
  EXPECT_EQ(p.live(9.5), Life::alive);
  p.job_silent = false;
  EXPECT_EQ(p.live(1), Life::alive);
  p.job_silent = true;
  EXPECT_EQ(p.live(9.5), Life::alive) << "it has spoken in between";
  EXPECT_EQ(p.live(1), Life::hung);
  EXPECT_TRUE(p.liveness.job_hung());
  Process starved;
  starved.live(5);
  starved.job_silent = true;
  EXPECT_EQ(starved.live(60, 0.9), Life::alive);
  EXPECT_FALSE(starved.liveness.job_hung());
}

TEST(Backoff, doubles_up_to_ten_seconds_and_forgets_after_a_stable_life) {
  Backoff backoff{BackoffSettings{}};
  for (const double wait : {0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 10.0, 10.0})
    EXPECT_DOUBLE_EQ(to_seconds(backoff.after_life_of(from_seconds(0.5))), wait);
  EXPECT_DOUBLE_EQ(to_seconds(backoff.after_life_of(from_seconds(31))), 0.1);
  EXPECT_DOUBLE_EQ(to_seconds(backoff.after_life_of(from_seconds(1))), 0.2);
}

}  // namespace
}  // namespace handsel::liveness_test
