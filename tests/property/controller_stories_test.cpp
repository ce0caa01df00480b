// SPDX-License-Identifier: Apache-2.0
// Random event sequences: for any commands, lost or malformed messages, every set-point keeps the
// guard limits and continues the preceding one.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <random>

#include "tests/support/allocation_counter.hpp"
#include "tests/support/controller_bench.hpp"

namespace handsel::trajectory_controller::controller_stories_test {
namespace {

class Story {
 public:
  explicit Story(std::uint64_t seed) : random_(seed) { bench.start(); }

  void event() {
    switch (integer(0, 17)) {
      case 0:
      case 1:
      case 2: {
        Vector goal(3);
        goal << real(-1.5, 1.5), real(-1.5, 1.5), real(-2.0, 2.0);
        const bool waits = integer(0, 2) == 0;
        Vector all = bench.core.set_point().position;
        all << goal, real(-0.2, 1.4), real(-0.2, 1.4), real(-1.5, 1.5), real(-0.7, 0.5);
        const TrajectoryCommand next =
            integer(0, 3) == 0 ? bench.command_all(all, ++id_) : bench.command(goal, ++id_);
        switches +=
            bench.send(next, 0.0, waits ? real(0.0, 5.0) : 0.0).empty() && !bench.at_rest() ? 1 : 0;
        break;
      }
      case 16:
      case 17:
        bench.external_torque = Vector::Zero(bench.robot->dof());
        bench.external_torque[integer(0, 2)] = integer(0, 1) ? real(-60.0, 60.0) : 0.0;
        break;
      case 3:
        bench.advice.speed_factor = real(-1.0, 1.0);
        break;
      case 4:
        bench.advice.speed_factor = 1.0;
        break;
      case 5:
        bench.go.allowed = integer(0, 2) > 0;
        ++bench.go.epoch;
        bench.go.acknowledge = true;
        break;
      case 6:
        bench.go.override_factor = real(0.1, 1.2);
        break;
      case 7:
        bench.robot_speaks = integer(0, 3) > 0;
        break;
      case 8:
        bench.human_speaks = integer(0, 3) > 0;
        break;
      case 9:
        bench.forecast_speaks = integer(0, 3) > 0;
        break;
      case 10:
        bench.attention_speaks = integer(0, 3) > 0;
        break;
      case 11:
        bench.drive =
            integer(0, 3) > 0 ? DriveMode::enabled : static_cast<DriveMode>(integer(0, 5));
        break;
      case 12:
        bench.people.people.clear();
        if (integer(0, 1)) bench.people.people = {bench.standing(real(0.4, 3.0), real(-1.0, 1.0))};
        for (Person& p : bench.people.people)
          for (BodyJoint& j : p.joints) j.velocity = Vector3(real(-2, 2), real(-2, 2), 0);
        bench.people.covered = integer(0, 5) > 0;
        break;
      case 13: {
        HandCommand c;
        c.robot = "small";
        c.id = ++id_;
        c.epoch = bench.go.epoch;
        c.action = static_cast<HandAction>(integer(0, 3));
        c.position = Vector(2);
        c.position << real(-0.3, 1.5), real(-0.3, 1.5);
        bench.core.accept(c, Duration(0), bench.now);
        break;
      }
      case 14:
        bench.advice.has_gaze_target = true;
        bench.advice.gaze_target = Vector3(real(-3, 3), real(-3, 3), real(0, 2));
        break;
      case 15:
        garbage();
        break;
    }
    if (integer(0, 3) == 0) heal();
  }

  /// Everybody speaks and agrees again, and there is something to do.
  void calm() {
    heal();
    bench.people.people.clear();
    bench.people.covered = true;
    bench.advice.speed_factor = bench.go.override_factor = 1.0;
    bench.forecast = {};
    bench.follows = true;
    bench.run(5.0);
    ++bench.go.epoch;
    bench.run(0.3);
    // A trajectory of arm and other axes is not replaced by one of the arm alone.
    for (int k = 0; k < 200 && bench.core.status_key().motion == MotionState::running; ++k)
      bench.run(0.1);
    Vector goal(3);
    goal << real(-1.5, 1.5), real(-1.5, 1.5), real(-2.0, 2.0);
    const std::string why = bench.go_to(goal, ++id_);
    if (!why.empty()) std::printf("a calm trajectory was refused: %s\n", why.c_str());
    sent += why.empty() ? 1 : 0;
  }

  test::ControllerBench bench;
  int sent{}, switches{};

 private:
  double real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  void heal() {
    bench.robot_speaks = bench.human_speaks = bench.forecast_speaks = bench.attention_speaks = true;
    bench.drive = DriveMode::enabled;
    bench.go.allowed = bench.go.acknowledge = true;
    bench.late = false;
    bench.external_torque.resize(0);
    ++bench.go.epoch;
  }
  void garbage() {
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity(), 1e308, -1e9, 5e-324};
    const double x = bad[integer(0, 4)];
    switch (integer(0, 6)) {
      case 0: {
        TrajectoryCommand c = bench.command(Vector::Constant(3, real(-1, 1)), ++id_);
        c.trajectory.axes[0].segments[0].jerk = x;
        bench.send(c);
        break;
      }
      case 1: {
        TrajectoryCommand c = bench.command(Vector::Constant(3, real(-1, 1)), ++id_);
        c.trajectory.axes[1].start.position = x;
        bench.send(c);
        break;
      }
      case 2: {
        TrajectoryCommand c = bench.command(Vector::Constant(3, real(-1, 1)), ++id_);
        for (AxisTrajectory& axis : c.trajectory.axes) axis.start.position += real(-0.06, 0.06);
        bench.send(c);
        break;
      }
      case 3: {
        AttentionAdvice a;
        a.speed_factor = x;
        bench.core.on(a, bench.now);
        break;
      }
      case 4: {
        RobotState s;
        s.robot = "small";
        s.position = Vector::Constant(bench.robot->dof(), x);
        s.sequence = 1;
        s.mode = DriveMode::enabled;
        if (!(std::abs(x) < 1e10)) bench.core.on(s, bench.now);
        break;
      }
      case 5: {
        TrajectoryForecast f;
        f.collides = true;
        f.trajectory = id_;
        f.time_to_collision = integer(0, 1) ? x : real(0, 3);
        bench.core.on(f, bench.now);
        break;
      }
      case 6:
        bench.late = integer(0, 1) > 0;
        break;
    }
  }

  std::mt19937_64 random_;
  std::uint64_t id_{};
};

constexpr double kStopSlack = 0.05;  // max extra time of a stop, guarantee 2 [s]

int steps_wanted() {
  const char* text = std::getenv("HANDSEL_STORY_STEPS");
  return text ? std::atoi(text) : 1'000'000;
}

TEST(ControllerStories, every_set_point_keeps_the_guard_limits_and_is_continuous) {
  const std::uint64_t seed = 20240601;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Story story(seed);
  story.bench.count_allocations = &test::allocations;
  std::mt19937_64 random(seed + 1);
  int left = 0, moved = 0, last_check_stops = 0, calm_finished = 0;
  for (int k = 0; k < steps_wanted(); ++k) {
    constexpr int kChapter = 20000, kCalm = 8000;
    if (k % kChapter == kChapter - kCalm) {
      story.calm();
      left = kCalm;
    }
    if (left-- <= 0) {
      story.event();
      left = std::uniform_int_distribution<int>(1, 400)(random);
    }
    const bool was_running = story.bench.core.status_key().motion == MotionState::running;
    story.bench.tick();
    if (k % kChapter > kChapter - kCalm && was_running &&
        story.bench.core.status_key().motion == MotionState::finished)
      ++calm_finished;
    if (!story.bench.at_rest()) ++moved;
    if (story.bench.core.status().causes & bit(Cause::limit_violation)) ++last_check_stops;
    ASSERT_LE(story.bench.worst_velocity, 1 + 1e-6) << "step " << k;
    ASSERT_LE(story.bench.worst_acceleration, 1 + 1e-6) << "step " << k;
    ASSERT_LE(story.bench.worst_jerk, 1 + 1e-6) << "step " << k;
    ASSERT_LE(story.bench.worst_jump, 1 + 1e-6) << "step " << k;
    ASSERT_LE(story.bench.latest_stop, kStopSlack) << "step " << k;
    ASSERT_LE(story.bench.latest_hold, kStopSlack) << "step " << k;
  }
  std::printf(
      "%d stops from motion, the latest %.0f ms after the fastest possible; %d holds along the "
      "path, the latest %.0f ms; %llu uses of "
      "the heap\n",
      story.bench.stops, 1e3 * story.bench.latest_stop, story.bench.holds,
      1e3 * story.bench.latest_hold, static_cast<unsigned long long>(story.bench.allocations));
  EXPECT_EQ(story.bench.allocations, 0u);
  EXPECT_GT(story.bench.stops, steps_wanted() / 20000);
  EXPECT_GT(story.bench.holds, 0);
  std::printf(
      "moving in %d of %d steps; %d times to another trajectory in motion; %d of %d calm "
      "trajectories finished; shares v %.6f a %.6f j "
      "%.6f\n",
      moved, steps_wanted(), story.switches, calm_finished, story.sent, story.bench.worst_velocity,
      story.bench.worst_acceleration, story.bench.worst_jerk);
  EXPECT_EQ(last_check_stops, 0);
  EXPECT_GT(story.switches, steps_wanted() / 20000);
  EXPECT_GT(moved, steps_wanted() / 10);
  EXPECT_GE(story.sent, steps_wanted() / 20000);
  EXPECT_EQ(calm_finished, story.sent);
}

TEST(ControllerStories, factors_that_change_all_the_time_never_break_a_limit_nor_leave_the_path) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::ControllerBench b;
    b.start();
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Vector goal(3);
    goal << 1.5 * unit(random), 1.5 * unit(random), 2.0 * unit(random);
    ASSERT_EQ(b.go_to(goal, 1), "");
    for (int k = 0; k < 40000 && b.core.status_key().motion == MotionState::running; ++k) {
      if (k % 100 == 0) {
        b.advice.speed_factor = std::min(1.0, 0.4 + unit(random));
        b.core.on(b.advice, b.now);
      }
      b.tick();
      ASSERT_LE(b.worst_jerk, 1 + 1e-6) << "seed " << seed << " step " << k;
      ASSERT_LE(b.worst_acceleration, 1 + 1e-6) << "seed " << seed << " step " << k;
    }
    EXPECT_EQ(b.core.status_key().motion, MotionState::finished) << "seed " << seed;
  }
}

TEST(ControllerStories, a_step_never_uses_the_heap) {
  test::ControllerBench b;
  b.people.people = {b.standing(1.0, 0.3)};
  b.start();
  std::uint64_t used = 0;
  int steps = 0;
  for (std::uint64_t id = 1; id <= 6; ++id) {
    Vector goal(3);
    goal << (id % 2 ? 0.9 : -0.2), 0.3, -0.4;
    b.go_to(goal, id);
    HandCommand c;
    c.robot = "small";
    c.id = id;
    c.epoch = b.go.epoch;
    c.action = id % 2 ? HandAction::grasp : HandAction::release_on_pull;
    c.position = Vector::Constant(2, 0.6);
    b.core.accept(c, Duration(0), b.now);
    for (int k = 0; k < 3000; ++k) {
      b.tick();
      const TimePoint now = b.now + from_seconds(b.settings.period);
      const std::uint64_t before = test::allocations();
      b.core.step(now, k % 7 == 0);
      used += test::allocations() - before;
      b.now = now;
      ++steps;
    }
    b.human_speaks = id % 3 != 0;
    b.forecast_speaks = id % 4 != 0;
    ++b.go.epoch;
  }
  EXPECT_EQ(used, 0u) << "in " << steps << " steps";
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_stories_test
