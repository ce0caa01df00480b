// SPDX-License-Identifier: Apache-2.0
// Latches survive the death of any process, over real processes: the arm is latched in the middle
// of a motion, a process is killed and restarts, and nothing moves before a person permits motion;
// then the arm moves. Without HANDSEL_RUNS: one death for each latch and the processes that keep
// it. HANDSEL_RUNS=n: every process n times for each latch, at random moments; HANDSEL_FIRST_SEED:
// of the first run; HANDSEL_LATCH, HANDSEL_PROCESS: only these (names separated by commas).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <random>
#include <sstream>

#include "tests/support/processes/background.hpp"
#include "tests/support/processes/busy_system.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::latches_test {
namespace {

using test::BusySystem;
using test::environment;

constexpr int kDomain = 212;
constexpr double kRest = 5e-4;  // max motion of an arm at rest, shown as 0.000 [rad]
constexpr double kTenth = 0.1;  // speed override
constexpr Duration kMoves = std::chrono::seconds(20);
constexpr Duration kBack = std::chrono::seconds(10);
// Observation time after the restart: without surviving latches, motion resumes after 1.3 s.
constexpr Duration kWatched = std::chrono::milliseconds(2000);

enum class Latch { pause, fault, protective_stop, override_speed };
constexpr const char* kLatchNames[] = {"pause", "fault", "protective_stop", "override"};
const char* name(Latch latch) { return kLatchNames[static_cast<std::size_t>(latch)]; }

struct Death {
  Latch latch{};
  std::string process;
  std::uint64_t seed{};
};

bool named(const std::string& list, const std::string& name) {
  if (list.empty()) return true;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');)
    if (word == name) return true;
  return false;
}

class LatchesOverDds : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // Keeps the latches of this test in its own folder.
    setenv("HANDSEL_STATE", folder().path().c_str(), 1);
    busy_ = std::make_unique<BusySystem>(kDomain);
    ASSERT_TRUE(busy_->ready());
  }
  static void TearDownTestSuite() { busy_.reset(); }
  static test::TemporaryFolder& folder() {
    static test::TemporaryFolder folder;
    return folder;
  }

  /// In the middle of a motion; false: it cannot be (a fault needs a motion long enough).
  bool latch(Latch latch, std::mt19937_64& random) {
    BusySystem& s = *busy_;
    for (int attempt = 0; attempt < 40; ++attempt) {
      if (!s.wait(kMoves, [&] { return s.travels(); })) return false;
      s.listen(from_seconds(std::uniform_real_distribution<double>(0.05, 0.8)(random)));
      if (!s.travels()) continue;
      switch (latch) {
        case Latch::pause:
          s.say(TaskKind::pause);
          return s.wait(from_seconds(3), [&] { return s.safety().paused && s.answered(); });
        case Latch::override_speed:
          s.say(TaskKind::speed, kTenth);
          return s.wait(from_seconds(3),
                        [&] { return s.safety().override_factor == kTenth && s.answered(); });
        case Latch::protective_stop:
          s.stop_robot("protective");
          return s.wait(from_seconds(3), [&] { return s.safety().awaits_person; });
        case Latch::fault:
          s.stop_robot("unannounced");
          if (s.wait(from_seconds(4), [&] { return s.safety().fault; })) return true;
          s.disturb(SimAction::robot_enable);
      }
    }
    return false;
  }

  /// On a busy machine the time of the system, and so a stop, is slower than this process' clock.
  bool comes_to_rest() {
    for (int look = 0; look < 10; ++look) {
      busy_->mark();
      busy_->listen(from_seconds(0.3));
      if (busy_->deviation() < 0.2 * kRest) return true;
    }
    return false;
  }

  static bool stands(Latch latch, const SafetyState& safety) {
    return latch == Latch::pause             ? safety.paused
           : latch == Latch::fault           ? safety.fault
           : latch == Latch::protective_stop ? safety.awaits_person
                                             : safety.override_factor == kTenth;
  }

  void release(Latch latch) {
    busy_->say(latch == Latch::override_speed ? TaskKind::speed
               : latch == Latch::fault        ? TaskKind::acknowledge
                                              : TaskKind::resume,
               1.0);
  }

  void die(const Death& death) {
    BusySystem& s = *busy_;
    const std::string what = std::string(name(death.latch)) + ", then kill -9 " + death.process +
                             ", seed " + std::to_string(death.seed);
    std::mt19937_64 random(death.seed);
    ASSERT_TRUE(latch(death.latch, random)) << what << ": " << s.safety().reason << "\n"
                                            << s.timeline();
    const bool halts = death.latch != Latch::override_speed;
    if (halts) {
      ASSERT_TRUE(s.wait(from_seconds(4), [&] { return !s.moves(); })) << what;
      ASSERT_TRUE(comes_to_rest()) << what << "\n" << s.timeline();
    }
    s.listen(from_seconds(std::uniform_real_distribution<double>(0.3, 1.0)(random)));
    s.mark();
    const std::uint64_t before = s.incarnation(death.process);
    s.kill(death.process);
    const TimePoint killed = monotonic_now();
    EXPECT_TRUE(s.wait(
        kBack, [&] { return s.incarnation(death.process) != before && s.is_ok(death.process); }))
        << what << ": not back";
    const double back = to_seconds(monotonic_now() - killed);
    s.listen(kWatched);
    EXPECT_TRUE(stands(death.latch, s.safety())) << what << ": the latch is gone";
    if (halts)
      EXPECT_LT(s.deviation(), kRest) << what << ": the arm moved\n" << s.timeline();
    else
      EXPECT_LE(s.fastest(), kTenth + 1e-6) << what << ": faster than the override";
    const double moved = s.deviation(), fastest = s.fastest();
    release(death.latch);
    EXPECT_TRUE(s.wait(from_seconds(5), [&] { return !stands(death.latch, s.safety()); }))
        << what << ": a person's word was not heard";
    s.mark();
    EXPECT_TRUE(s.wait(kMoves, [&] { return s.deviation() > 0.02; }))
        << what << ": it does not move again: " << s.safety().reason << "\n"
        << s.timeline();
    std::printf("%-62s back %.1f s, %s\n", what.c_str(), back,
                (halts ? "moved " + std::to_string(moved) + " rad"
                       : "speed factor at most " + std::to_string(fastest))
                    .c_str());
    std::fflush(stdout);
  }

  static std::vector<Death> deaths() {
    const std::string runs = environment("HANDSEL_RUNS"), first = environment("HANDSEL_FIRST_SEED");
    std::uint64_t seed = first.empty() ? 100 : std::stoull(first);
    if (runs.empty())
      return {{Latch::pause, "supervisor", seed},
              {Latch::pause, "trajectory_controller", seed + 1},
              {Latch::pause, "spark", seed + 2},
              {Latch::protective_stop, "supervisor", seed + 3},
              {Latch::fault, "trajectory_controller", seed + 4},
              {Latch::override_speed, "supervisor", seed + 5}};
    std::vector<Death> out;
    for (std::uint64_t run = 0; run < std::stoull(runs); ++run)
      for (const Latch latch :
           {Latch::pause, Latch::fault, Latch::protective_stop, Latch::override_speed})
        for (const std::string process : kProcesses) {
          ++seed;
          // The simulator is the environment: after its restart the arm is elsewhere.
          if (process != "sim" && named(environment("HANDSEL_LATCH"), name(latch)) &&
              named(environment("HANDSEL_PROCESS"), process))
            out.push_back({latch, process, seed});
        }
    return out;
  }

  static std::unique_ptr<BusySystem> busy_;
};
std::unique_ptr<BusySystem> LatchesOverDds::busy_;

TEST_F(LatchesOverDds, outlive_every_process_until_a_person_releases_them) {
  int done = 0;
  for (const Death& death : deaths()) {
    die(death);
    if (testing::Test::HasFatalFailure()) return;
    ++done;
  }
  const GroundTruth& ground_truth = busy_->now().ground_truth.sample;
  EXPECT_EQ(ground_truth.limit_violations, 0u);
  EXPECT_EQ(ground_truth.ssm_violations, 0u);
  std::printf("%d deaths\n", done);
}

TEST(KilledSystem, leaves_the_pause_to_the_next_one_and_an_orderly_end_does_not) {
  using testing::HasSubstr;
  const test::TemporaryFolder folder;
  setenv("HANDSEL_STATE", folder.path().c_str(), 1);
  const std::string domain = std::to_string(kDomain + 1), of_domain = " --domain " + domain;
  const auto paused = [&] {
    return test::shell(std::string(HANDSEL_COMMAND) + " status --json" + of_domain)
               .out.find("\"paused\":true") != std::string::npos;
  };
  const std::vector<std::string> up{HANDSEL_COMMAND, "up",   "--headless", "--port", "0",
                                    "--scenario",    "idle", "--domain",   domain};
  {
    test::Background first(up);
    ASSERT_TRUE(first.wait_for("ready after")) << first.said();
    const test::Outcome pause =
        test::shell(std::string(HANDSEL_COMMAND) + " task pause" + of_domain);
    ASSERT_EQ(pause.exit_code, 0) << pause.out << pause.err;
    EXPECT_TRUE(paused());
    first.send(SIGKILL);
    ASSERT_GE(first.wait(5), 0);
  }
  {
    test::Background second(up);
    ASSERT_TRUE(second.wait_for("ready after")) << second.said();
    EXPECT_THAT(
        second.said(),
        HasSubstr(
            "did not end in order; still in force: paused by a person (`handsel task resume`)"));
    EXPECT_TRUE(paused());
    EXPECT_EQ(second.interrupt(), 0);
  }
  test::Background third(up);
  ASSERT_TRUE(third.wait_for("ready after")) << third.said();
  EXPECT_THAT(third.said(), testing::Not(HasSubstr("still in force")));
  EXPECT_FALSE(paused());
}

}  // namespace
}  // namespace handsel::latches_test
