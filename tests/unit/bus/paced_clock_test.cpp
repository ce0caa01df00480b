// SPDX-License-Identifier: Apache-2.0
#include "common/bus/paced_clock.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <vector>

#include "common/bus/executor.hpp"
#include "tests/unit/bus/voluntary_switches.hpp"

using namespace handsel;
using test::voluntary_switches;

namespace {

TimePoint at(double seconds) { return TimePoint(from_seconds(seconds)); }
TimeGrant until(double seconds, double waited = 0, std::uint64_t incarnation = 1) {
  return {.incarnation = incarnation, .until = at(seconds), .waited = from_seconds(waited)};
}

TEST(PacedClock, is_the_machines_clock_until_the_first_grant) {
  PacedClock clock;
  EXPECT_EQ(clock.at(at(7)), at(7));
  EXPECT_EQ(clock.look_at(at(9), at(7)), at(9));
  EXPECT_FALSE(clock.paced());
}

TEST(PacedClock, stands_still_where_no_more_is_granted) {
  PacedClock clock;
  ASSERT_TRUE(clock.grant(until(10.02), at(10)));
  EXPECT_EQ(clock.at(at(10.01)), at(10.01));
  EXPECT_EQ(clock.at(at(10.05)), at(10.02));
  ASSERT_TRUE(clock.grant(until(10.03, 0.03), at(10.05)));
  EXPECT_EQ(clock.at(at(10.055)), at(10.025));
}

TEST(PacedClock, never_goes_back_after_the_first_grant) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  clock.at(at(10.02));
  clock.grant(until(10.04, 0.015), at(10.021));
  EXPECT_EQ(clock.at(at(10.022)), at(10.02));
  EXPECT_EQ(clock.at(at(10.04)), at(10.025));
}

TEST(PacedClock, takes_the_systems_time_from_the_first_grant_also_when_that_is_earlier) {
  PacedClock clock;
  EXPECT_EQ(clock.at(at(100)), at(100));
  clock.grant(until(60.02, 40), at(100));
  EXPECT_EQ(clock.at(at(100.01)), at(60.01));
}

TEST(PacedClock, goes_on_when_the_simulator_has_been_silent_for_a_second) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  double wall = 10;
  for (; wall < 10.9; wall += 0.02) clock.at(at(wall));
  EXPECT_EQ(clock.at(at(wall)), at(10.02));
  for (; wall < 11.3; wall += 0.02) clock.at(at(wall));
  EXPECT_FALSE(clock.paced());
  const TimePoint begin = clock.at(at(12));
  EXPECT_EQ(clock.at(at(13)) - begin, from_seconds(1));
  EXPECT_LT(begin, at(11.1)) << "time has jumped";
}

TEST(PacedClock, a_process_that_got_no_processor_does_not_blame_the_simulator) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  clock.at(at(10.02));
  EXPECT_EQ(clock.at(at(15)), at(10.02));
  EXPECT_TRUE(clock.paced());
}

TEST(PacedClock, a_process_that_was_stopped_first_hears_whether_it_was_waited_for) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  clock.at(at(10.005));
  EXPECT_EQ(clock.at(at(11)), at(10.005)) << "what was granted a second ago is old";
  clock.grant(until(10.03), at(11.001));  // read late, therefore old
  EXPECT_EQ(clock.at(at(11.001)), at(10.005));
  clock.grant(until(11.02), at(11.002));
  EXPECT_EQ(clock.at(at(11.002)), at(11.002)) << "the simulator has gone on";
}

TEST(PacedClock, a_process_that_was_starved_makes_up_for_what_was_granted) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  clock.at(at(10.005));
  EXPECT_EQ(clock.at(at(11)), at(10.005));
  clock.grant(until(10.02, 0.985), at(11.001));  // repeated: the simulator has waited
  EXPECT_EQ(clock.at(at(11.001)), at(10.016));
}

TEST(PacedClock, only_one_simulator_gives_the_pace) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  EXPECT_FALSE(clock.grant(until(99, 0, 2), at(10.01)));
  EXPECT_EQ(clock.at(at(10.05)), at(10.02));
}

TEST(PacedClock, an_earlier_arrival_is_never_in_the_future) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  clock.at(at(10.05));
  EXPECT_EQ(clock.past(at(10.01)), at(10.01));
  EXPECT_EQ(clock.past(at(10.04)), at(10.02));
}

TEST(PacedClock, what_arrived_while_time_stood_still_arrived_then) {
  PacedClock clock;
  clock.grant(until(10.02), at(10));
  clock.at(at(10.02));
  clock.grant(until(10.03, 0.05), at(10.07));  // time stood still for 50 ms
  clock.at(at(10.075));
  EXPECT_EQ(clock.past(at(10.01)), at(10.01));
  EXPECT_EQ(clock.past(at(10.04)), at(10.02)) << "in the middle";
  EXPECT_EQ(clock.past(at(10.073)), at(10.023));
}

TEST(Executor, makes_up_for_every_tick_of_granted_time_at_the_instant_it_was_due) {
  Executor executor([](const std::string&) {});
  const TimePoint start = monotonic_now();
  executor.grant({.incarnation = 1, .until = start + from_seconds(0.02), .waited = {}});
  std::vector<Duration> ticks;
  TimePoint before{};
  const TimerStatus& status = executor.every(from_seconds(0.001), [&](TimePoint now) {
    EXPECT_EQ(now, executor.now());
    if (!ticks.empty()) ticks.push_back(now - before);
    if (ticks.empty()) ticks.emplace_back();
    before = now;
  });
  timespec nap{0, 15'000'000};
  nanosleep(&nap, nullptr);  // emulates a process without a processor
  executor.run_until([] { return false; }, from_seconds(0.1));
  EXPECT_GE(ticks.size(), 18u);
  EXPECT_LE(ticks.size(), 20u) << "time has passed what was granted";
  for (std::size_t i = 1; i < ticks.size(); ++i) EXPECT_EQ(ticks[i], from_seconds(0.001));
  EXPECT_EQ(status.late_cycles, 0u);
  EXPECT_EQ(status.skipped, 0u);
}

TEST(Executor, of_the_ticks_before_a_jump_of_time_only_the_newest_is_served) {
  Executor executor([](const std::string&) {});
  TimePoint start = monotonic_now();
  executor.grant({.incarnation = 1, .until = start + from_seconds(0.02), .waited = {}});
  std::vector<TimePoint> ticks;
  const TimerStatus& status =
      executor.every(from_seconds(0.001), [&](TimePoint now) { ticks.push_back(now); });
  timespec nap{0, 150'000'000};
  nanosleep(&nap, nullptr);  // emulates a stopped process for which the simulator does not wait
  executor.run_until([] { return false; }, from_seconds(0.005));
  EXPECT_TRUE(ticks.empty()) << "a tick of what was granted long ago";
  const TimePoint now = monotonic_now();
  executor.grant({.incarnation = 1, .until = now, .waited = {}});
  executor.run_until([] { return false; }, from_seconds(0.005));
  ASSERT_EQ(ticks.size(), 1u);
  EXPECT_LE(now - ticks[0], from_seconds(0.001)) << "served at an instant that is past";
  EXPECT_EQ(status.late_cycles, 1u);
  EXPECT_GT(status.skipped, 100u);
}

TEST(Executor, a_reminder_is_served_at_the_instant_of_the_tick_that_follows) {
  Executor executor([](const std::string&) {});
  std::vector<TimePoint> reminders, ticks;
  executor.on_wake([&] { reminders.push_back(executor.now()); });
  executor.grant({.incarnation = 1, .until = monotonic_now() + from_seconds(0.1), .waited = {}});
  executor.every(from_seconds(0.001), [&](TimePoint now) { ticks.push_back(now); });
  const timespec nap{0, 5'000'000};
  nanosleep(&nap, nullptr);  // several ticks are due
  executor.remind();
  executor.run_until([&] { return ticks.size() >= 20; }, from_seconds(0.1));
  ASSERT_EQ(reminders.size(), 1u);
  ASSERT_GE(ticks.size(), 20u);
  EXPECT_EQ(reminders[0], ticks[0]) << "served at another instant than the first tick";
  for (std::size_t i = 1; i < ticks.size(); ++i)
    EXPECT_EQ(ticks[i] - ticks[i - 1], from_seconds(0.001));
}

TEST(Executor, wakes_less_often_than_it_ticks_while_time_is_granted) {
  Executor executor([](const std::string&) {});
  executor.grant({.incarnation = 1, .until = monotonic_now() + from_seconds(1), .waited = {}});
  int ticks = 0;
  executor.every(from_seconds(0.001), [&](TimePoint) { ++ticks; });
  const long before = voluntary_switches();
  executor.run_until([&] { return ticks >= 200; }, from_seconds(2));
  EXPECT_GE(ticks, 200);
  EXPECT_LE(voluntary_switches() - before, 130);
}

TEST(Executor, heartbeats_go_on_while_time_stands_still) {
  Executor executor([](const std::string&) {});
  executor.grant({.incarnation = 1, .until = monotonic_now(), .waited = {}});
  int beats = 0, ticks = 0;
  executor.every_real(from_seconds(0.01), [&](TimePoint) { ++beats; });
  executor.every(from_seconds(0.01), [&](TimePoint) { ++ticks; });
  executor.run_until([] { return false; }, from_seconds(0.3));
  EXPECT_GE(beats, 10);
  EXPECT_EQ(ticks, 0);
}

/// A job that is at work until the test ends, and whether it gives no sign of life.
class SilentJob : public testing::Test {
 protected:
  ~SilentJob() override {
    stop_ = true;
    executor_.end_jobs(from_seconds(5));
  }

  /// Runs a job that only calls `step` until the test ends; returns when the job has begun.
  void begin(std::function<void()> step) {
    executor_.run_job(
        [this, step = std::move(step)](const CancelToken&) {
          begun_ = true;
          while (!stop_) step();
          return Duration{};
        },
        [] {});
    while (!begun_) sched_yield();
    EXPECT_FALSE(executor_.job_silent(begin_)) << "the begin of the silence";
  }

  Executor executor_{[](const std::string&) {}};
  std::atomic<bool> stop_{false}, begun_{false};
  TimePoint begin_ = monotonic_now();
};

TEST_F(SilentJob, is_one_that_waits_only_after_ten_seconds) {
  begin([] {
    timespec nap{0, 1'000'000};
    nanosleep(&nap, nullptr);  // has no processor
  });
  EXPECT_FALSE(executor_.job_silent(begin_ + from_seconds(9)));
  EXPECT_TRUE(executor_.job_silent(begin_ + from_seconds(11)));
}

TEST_F(SilentJob, is_one_that_computes_for_two_seconds) {
  begin([] {});
  EXPECT_FALSE(executor_.job_silent(begin_ + from_seconds(1)));
  executor_.run_until([&] { return executor_.job_silent(begin_ + from_seconds(1)); },
                      from_seconds(60));
  EXPECT_TRUE(executor_.job_silent(begin_ + from_seconds(1)));
}

}  // namespace
