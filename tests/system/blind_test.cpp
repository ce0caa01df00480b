// SPDX-License-Identifier: Apache-2.0
// No arm moves blind, over real processes: while the arm carries a mug beside a person, the sources
// of people fall silent, freeze, repeat an empty sample, are late or observe another space. The arm
// comes to rest in time, the cause is named, the arm rests during the disturbance and completes its
// task afterwards. Without HANDSEL_RUNS: each kind once. HANDSEL_RUNS=n: n times at random moments;
// HANDSEL_FIRST_SEED: of the first run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <random>

#include "common/messages/names.hpp"
#include "tests/support/processes/busy_system.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::blind_test {
namespace {

using test::BusySystem;
using test::environment;

constexpr int kDomain = 215;
constexpr double kRest = 1e-3;       // max motion of an arm at rest [rad]
constexpr double kMinMotion = 0.01;  // min motion of an arm that continues [rad]
constexpr double kNamed = 1.0;       // max time until the cause is named [s]
constexpr double kLasts = 2.0;       // duration of a disturbance [s]
constexpr Duration kMoves = std::chrono::seconds(20), kCompletes = std::chrono::seconds(60);

// Terms of the max time to rest [s]. The last valid sample is captured before the disturbance or
// one sensor period later (a frozen source repeats its first sample). A view is live for
// max_view_age after that; the stop lasts at most the longest stop of an axis; P2 allows 50 ms
// more. Added are the transport of messages and the servo of the simulated robot (60 rad/s, 1 mrad
// after 0.1 s).
constexpr double kViewAge = 0.25, kSensorPeriod = 1.0 / 30, kPromised = 0.05, kTransport = 0.02,
                 kServo = 0.1;

struct Kind {
  const char* name;
  SimAction action;
  double value;
};
constexpr Kind kKinds[] = {{"silent", SimAction::silence_human, 0.0},
                           {"frozen", SimAction::human_frozen, 0.0},
                           {"empty", SimAction::human_empty, 0.0},
                           {"late", SimAction::human_late, 0.5},
                           {"elsewhere", SimAction::human_elsewhere, 0.0}};

class BlindOverDds : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("HANDSEL_STATE", folder().path().c_str(), 1);
    busy_ = std::make_unique<BusySystem>(kDomain);
    ASSERT_TRUE(busy_->ready());
  }
  static void TearDownTestSuite() { busy_.reset(); }
  static test::TemporaryFolder& folder() {
    static test::TemporaryFolder folder;
    return folder;
  }

  static bool names_cause() {
    const Snapshot& now = busy_->now();
    const ExecutionStatus& status = now.execution.sample;
    return (status.causes & (1U << static_cast<unsigned>(Cause::blind))) != 0 &&
           status.reason.find("kinect") != std::string::npos;
  }
  static bool health_names_source() {
    for (const auto& [component, health] : busy_->now().health)
      if (health.sample.state == HealthState::degraded &&
          health.sample.reason.find("kinect") != std::string::npos)
        return true;
    return false;
  }
  /// In the middle of a motion.
  static bool wait_moving(std::mt19937_64& random) {
    for (int attempt = 0; attempt < 8; ++attempt) {
      if (!busy_->wait(kMoves, [] { return busy_->moves(); })) return false;
      busy_->listen(from_seconds(std::uniform_real_distribution<double>(0.05, 0.8)(random)));
      if (busy_->moves()) return true;
    }
    return false;
  }

  static void blind(const Kind& kind, std::uint64_t seed) {
    BusySystem& s = *busy_;
    const std::string what = std::string(kind.name) + ", seed " + std::to_string(seed);
    std::mt19937_64 random(seed);
    ASSERT_TRUE(wait_moving(random))
        << what << ": it does not move: " << s.now().execution.sample.reason;
    const std::uint64_t task = s.task();
    const std::uint64_t ssm = s.now().ground_truth.sample.ssm_violations,
                        limits = s.now().ground_truth.sample.limit_violations;
    const double bound =
        kSensorPeriod + kViewAge + s.longest_stop() + kPromised + kTransport + kServo;
    const TimePoint begin = monotonic_now();
    const auto since = [&] { return to_seconds(monotonic_now() - begin); };
    s.disturb(kind.action, kind.value);
    double named = -1, healthy = -1;
    const auto look = [&] {
      if (named < 0 && names_cause()) named = since();
      if (healthy < 0 && health_names_source()) healthy = since();
      return false;
    };
    s.wait(from_seconds(bound), look);
    s.mark();
    s.wait(from_seconds(kLasts - bound), look);
    EXPECT_LT(s.deviation(), kRest)
        << what << ": it moves " << bound << " s after the disturbance began, or later";
    EXPECT_TRUE(named >= 0 && named <= kNamed)
        << what << ": named after " << named << " s: " << s.now().execution.sample.reason;
    EXPECT_TRUE(healthy >= 0 && healthy <= kNamed)
        << what << ": in no health, or after " << healthy << " s";
    const double moved = s.deviation();
    s.mark();
    s.disturb(SimAction::restore);
    const TimePoint restored = monotonic_now();
    EXPECT_TRUE(s.wait(kMoves, [] { return busy_->deviation() > kMinMotion; }))
        << what << ": it does not go on: " << s.now().execution.sample.reason;
    const double resumed = to_seconds(monotonic_now() - restored);
    const auto over = [&] {
      const auto found = s.now().tasks.find(task);
      return found != s.now().tasks.end() && is_over(found->second.state);
    };
    EXPECT_TRUE(s.wait(kCompletes, over)) << what << ": the task does not end\n" << s.timeline();
    const TaskStatus end = over() ? s.now().tasks.at(task) : TaskStatus{};
    EXPECT_EQ(end.state, TaskState::succeeded)
        << what << ": " << name(end.state) << ": " << end.reason;
    EXPECT_EQ(s.now().ground_truth.sample.ssm_violations, ssm) << what;
    EXPECT_EQ(s.now().ground_truth.sample.limit_violations, limits) << what;
    std::printf(
        "%-22s moved %.6f rad from %.2f s on, named after %.2f s, in health after %.2f s, moved "
        "again %.2f s after the end\n",
        what.c_str(), moved, bound, named, healthy, resumed);
    std::fflush(stdout);
  }

  static std::unique_ptr<BusySystem> busy_;
};
std::unique_ptr<BusySystem> BlindOverDds::busy_;

TEST_F(BlindOverDds, stops_in_time_says_why_and_completes_the_task_when_it_sees_again) {
  const std::string runs = environment("HANDSEL_RUNS"), first = environment("HANDSEL_FIRST_SEED");
  std::uint64_t seed = first.empty() ? 300 : std::stoull(first);
  int done = 0;
  for (int run = 0; run < (runs.empty() ? 1 : std::stoi(runs)); ++run)
    for (const Kind& kind : kKinds) {
      blind(kind, seed++);
      if (testing::Test::HasFatalFailure()) return;
      ++done;
    }
  std::printf("%d runs\n", done);
}

}  // namespace
}  // namespace handsel::blind_test
