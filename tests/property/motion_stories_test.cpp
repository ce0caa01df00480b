// SPDX-License-Identifier: Apache-2.0
// Random event sequences of a running motion: switch, slow down, stop, recoil, resume, at random
// times. Every sample is within the limits and continues the preceding one. HANDSEL_RUNS=1000000
// for the long run.
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <map>
#include <random>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/time_scaling.hpp"
#include "tests/support/motion_draw.hpp"

namespace handsel::motion_stories_test {
namespace {

using Eigen::VectorXd;

constexpr double kTolerance = 1e-6;

struct Story {
  explicit Story(std::uint64_t seed) : random(seed) {}
  double draw(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  }
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); }
  VectorXd point(double reach) {
    VectorXd v(guard.velocity.size());
    for (double& x : v) x = draw(-reach, reach);
    return v;
  }

  /// Straight, with corners, or beginning in motion.
  Trajectory trajectory(const VectorXd& near) {
    const double reach = std::pow(10.0, draw(-2, 0.3));
    std::vector<VectorXd> nodes{near};
    const int segments = 1 + pick(3);
    for (int i = 0; i < segments; ++i) nodes.push_back(nodes.back() + point(reach));
    Trajectory whole = smooth(nodes, planning).trajectory;
    return pick(3) == 0 ? cut(whole, draw(0, 0.9) * whole.duration(), whole.duration()) : whole;
  }

  void begin() {
    static constexpr std::array<double, 4> kSteps{0.001, 0.002, 0.004, 0.008};
    const int n = 1 + pick(pick(2) == 0 ? 2 : 7);
    dt = kSteps[pick(4)];
    guard = {VectorXd(n), VectorXd(n), VectorXd(n)};
    for (int i = 0; i < n; ++i)
      guard.velocity[i] = draw(0.3, 2), guard.acceleration[i] = draw(0.6, 4),
      guard.jerk[i] = draw(2, 16);
    planning = {guard.velocity / 1.1, guard.acceleration / 1.1, guard.jerk / 1.1};
    Trajectory first = trajectory(point(1));
    const MotionState3 start = first.at(0);
    if (start.velocity.norm() + start.acceleration.norm() == 0 && pick(2) == 0)
      first = shifted(first, draw(0, 0.3));
    ASSERT_EQ(law.init(first, guard, dt), "");
    last = law.state();
  }

  void tick() {
    law.advance(dt);
    ++samples;
    const MotionState3& now = law.state();
    for (Eigen::Index i = 0; i < now.position.size(); ++i) {
      const double V = guard.velocity[i], A = guard.acceleration[i], J = guard.jerk[i];
      const double x0 = last.position[i], v0 = last.velocity[i], a0 = last.acceleration[i];
      const double x1 = now.position[i], v1 = now.velocity[i], a1 = now.acceleration[i];
      const double ratio = std::max({std::abs(v1) / V, std::abs(a1) / A,
                                     std::abs(a1 - a0) / (J * dt), std::abs(law.jerk()[i]) / J});
      largest = std::max(largest, ratio);
      if (!(ratio <= 1 + kTolerance)) {
        ADD_FAILURE() << told << "axis " << i << ": velocity " << v1 / V << ", acceleration "
                      << a1 / A << ", change of acceleration " << (a1 - a0) / (J * dt) << ", jerk "
                      << law.jerk()[i] / J << " of the limit";
        failed = true;
        return;
      }
      const double x_gap = std::abs(x1 - x0 - dt * (v0 + v1) / 2 + dt * dt * (a1 - a0) / 12),
                   v_gap = std::abs(v1 - v0 - dt * (a0 + a1) / 2);
      if (!(x_gap <= J * dt * dt * dt / 12 + 1e-9 &&
            v_gap <= J * dt * dt / 4 * (1 + kTolerance) + 1e-9)) {
        ADD_FAILURE() << told << "axis " << i << " is not continuous: position " << x_gap
                      << ", velocity " << v_gap;
        failed = true;
        return;
      }
    }
    for (const VectorXd* part : {&now.position, &now.velocity, &now.acceleration}) {
      for (const double x : *part)
        hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211ULL;
    }
    last = now;
  }

  void run(double seconds) {
    for (double t = 0; t < seconds && !failed; t += dt) tick();
  }

  void event() {
    switch (pick(7)) {
      case 0:
      case 1: {
        SwitchSettings settings;
        const Trajectory next =
            trajectory(law.state().position + (pick(4) == 0 ? point(0.5) : point(0.01)));
        settings.on_clock = pick(4) == 0;
        if (pick(4) == 0) settings.last = draw(0, 1) * next.duration();
        if (pick(3) == 0) settings.tries = 6;
        const bool afresh = pick(4) == 0;
        const SegmentTable table(next);
        const SwitchOutcome outcome =
            afresh ? law.start_from(MotionState3(law.state()), table, settings)
                   : law.switch_to(table, settings);
        ++count[outcome == SwitchOutcome::ok ? (afresh ? "started afresh" : "switched")
                                             : reason(outcome)];
        break;
      }
      case 2:
        law.set_target(draw(0, 1)), ++count["slow"];
        break;
      case 3:
        law.set_target(0), ++count["stop"];
        break;
      case 4:
        law.set_target(draw(-1, 0)), ++count["recoil"];
        break;
      default:
        law.set_target(1), ++count["resume"];
    }
  }

  std::mt19937_64 random;
  KinematicLimits guard, planning;
  TimeScaling law;
  MotionState3 last;
  double dt{}, largest{};
  bool failed{};
  std::string told;
  long samples{};
  std::uint64_t hash{1469598103934665603ULL};
  std::map<std::string, long> count;
};

std::uint64_t first_seed() {
  return std::getenv("HANDSEL_SEED") ? std::strtoull(std::getenv("HANDSEL_SEED"), nullptr, 10) : 1;
}

/// Tells the story of a seed.
Story told(std::uint64_t seed) {
  Story story(seed);
  story.told = "seed " + std::to_string(seed) + ": ";
  story.begin();
  const int events = 2 + story.pick(5);
  for (int e = 0; e < events && !story.failed; ++e) {
    story.run(story.draw(0, 0.8) * story.draw(0, 1));
    if (!story.failed) story.event();
  }
  story.run(story.draw(0, 0.5));
  return story;
}

TEST(MotionStories, every_sample_is_within_the_limits_and_continuous) {
  const int stories = test::runs(3000);
  long samples = 0;
  std::uint64_t hash = 0;
  double largest = 0;
  std::map<std::string, long> count;
  for (int k = 0; k < stories; ++k) {
    const Story story = told(first_seed() + k);
    samples += story.samples;
    largest = std::max(largest, story.largest);
    for (const auto& [what, times] : story.count) count[what] += times;
    hash += story.hash;
  }
  printf("%d stories, %ld samples (hash %016llx), seeds from %llu, largest share of a limit %.9f\n",
         stories, samples, static_cast<unsigned long long>(hash),
         static_cast<unsigned long long>(first_seed()), largest);
  for (const auto& [what, times] : count) printf("  %-70s %ld\n", what.c_str(), times);
  EXPECT_GT(count["switched"], stories / 2);
  EXPECT_GT(count["started afresh"], stories / 10);
}

TEST(MotionStories, that_once_went_wrong) {
  for (const std::uint64_t seed :
       {8649, 744831, 1020995, 1082078, 1117332, 1157086, 1218998, 1247578, 1507586})
    told(seed);
}

}  // namespace
}  // namespace handsel::motion_stories_test
