// SPDX-License-Identifier: Apache-2.0
// The deployment of docker-compose.yml without a container engine: every service in a network
// namespace with its own address; and perception on another host, with an interrupted link.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>

#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/compose_file.hpp"
#include "tests/support/processes/hosts.hpp"

namespace handsel::test::hosts_test {
namespace {

namespace fs = std::filesystem;

constexpr int kDomain = 39;
const fs::path kPrograms = fs::path(HANDSEL_COMMAND).parent_path();

std::string seconds(Duration time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", to_seconds(time));
  return text;
}

std::string told(const Snapshot& now) {
  std::string text = "mode " + std::string(name(now.execution.sample.mode)) + ", causes " +
                     cause_names(now.execution.sample.causes);
  for (const std::string& one : not_ready(now)) text += "; " + one;
  return text + "; task " + name(now.task.sample.state) + " " + now.task.sample.reason;
}

/// Passes if the handover counts within two seconds: it does once the person has held the object
/// alone for one second, and the task may end before that.
testing::AssertionResult handover_counts(Session& session) {
  const GroundTruth& truth = session.snapshot().ground_truth.sample;
  if (session.wait(from_seconds(2), [&] { return truth.handover_done; }))
    return testing::AssertionSuccess();
  return testing::AssertionFailure()
         << "held by '" << truth.carrier << "', lifted " << truth.max_lifted
         << " m, contact before the release " << truth.human_contact_before_release
         << " s, alone for " << truth.human_alone << " s, dropped " << truth.dropped;
}

class OnHosts : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Hosts::why_not(); !why.empty()) GTEST_SKIP() << why;
    unsetenv("CYCLONEDDS_URI");
    setenv("HANDSEL_DOMAIN", std::to_string(kDomain).c_str(), 1);
    setenv("HANDSEL_WEB_PORT", "8765", 1);
  }
  void TearDown() override {
    if (HasFailure()) note("timeline:\n" + timeline_);
    for (const auto& [host, one] : running_)
      one->send(SIGTERM);  // all at once, then waits for each
  }
  static void note(const std::string& text) {
    std::printf("%s\n", text.c_str());
    std::fflush(stdout);  // before another process inherits it
  }

  /// Records the events, printed after a failure.
  void keep_timeline(Session& session) {
    session.observer().on_event([this](const TimelineEvent& event) {
      timeline_ += seconds(event.at.time_since_epoch()) + "  " + event.text + "\n";
    });
  }
  void start(const std::string& host, std::vector<std::string> command) {
    command[0] = kPrograms / command[0];
    running_[host] = std::make_unique<Background>(hosts_->on(host, command));
  }
  std::string said(const std::string& host) const {
    return running_.at(host)->said() + running_.at(host)->printed();
  }

  std::string timeline_;
  std::unique_ptr<Hosts> hosts_;
  std::map<std::string, std::unique_ptr<Background>> running_;  // ended before the hosts are
};

TEST_F(OnHosts, every_service_of_the_compose_file_on_its_own_address_hands_over_and_comes_back) {
  const auto services =
      compose_services(text_of(fs::path(HANDSEL_SOURCE_DIR) / "deploy/docker-compose.yml"));
  std::vector<std::string> names{"operator"};
  for (const auto& [service, text] : services) names.push_back(service);
  hosts_ = std::make_unique<Hosts>(names);
  setenv("HANDSEL_PEERS", "multicast", 1);
  hosts_->move_here("operator");
  const auto start_service = [&](const std::string& service) {
    start(service, compose_command(services.at(service)));
  };
  for (const auto& [service, text] : services)
    if (service != "spark") start_service(service);

  // Perception is missing: no motion, and the missing source is named.
  Session session(kDomain);
  keep_timeline(session);
  const Snapshot& now = session.snapshot();
  ASSERT_TRUE(session.wait(from_seconds(15), [&] {
    return now.health.size() == services.size() - 1;
  })) << told(now);
  EXPECT_THAT(not_ready(now), testing::Contains("spark (nothing received yet)"));
  ASSERT_TRUE(session.send({.id = session.new_task_id(), .kind = TaskKind::give, .object = "mug"}));
  EXPECT_FALSE(session.wait(from_seconds(1.0), [&] {
    return now.ground_truth.ever && now.ground_truth.sample.robot_moving;
  })) << told(now);
  session.send({.id = session.new_task_id(), .kind = TaskKind::cancel});

  const TimePoint begun = monotonic_now();
  start_service("spark");
  ASSERT_TRUE(session.wait(from_seconds(15), [&] { return not_ready(now).empty(); })) << told(now);
  note("spark joined " + seconds(monotonic_now() - begun) + " after its start");

  const std::uint64_t task = session.new_task_id();
  ASSERT_TRUE(session.wait(from_seconds(5), [&] {
    return !now.task.ever || is_over(now.task.sample.state);
  })) << told(now);
  ASSERT_TRUE(session.send({.id = task, .kind = TaskKind::give, .object = "mug"}));
  ASSERT_TRUE(session.wait(from_seconds(20), [&] { return now.ground_truth.sample.robot_moving; }))
      << told(now);
  const std::uint64_t incarnation = now.health.at("path_planner").sample.incarnation;
  running_.erase("path_planner");
  start_service("path_planner");
  EXPECT_TRUE(session.wait(from_seconds(5), [&] {
    const ComponentHealth& back = now.health.at("path_planner").sample;
    return back.incarnation != incarnation && back.state == HealthState::ok;
  })) << told(now);
  EXPECT_TRUE(session.wait(from_seconds(60), [&] {
    return now.tasks.contains(task) && is_over(now.tasks.at(task).state);
  })) << told(now);
  EXPECT_EQ(now.tasks.at(task).state, TaskState::succeeded) << told(now);
  EXPECT_TRUE(handover_counts(session));
  EXPECT_EQ(now.ground_truth.sample.limit_violations, 0u);
  EXPECT_EQ(now.ground_truth.sample.ssm_violations, 0u);
}

TEST_F(OnHosts, the_link_to_perception_is_cut_for_two_seconds) {
  hosts_ = std::make_unique<Hosts>(std::vector<std::string>{"robot", "perception"});
  const std::string peers = hosts_->address("robot") + "," + hosts_->address("perception");
  setenv("HANDSEL_PEERS", peers.c_str(), 1);  // the one variable, the same on both hosts
  hosts_->move_here("robot");
  start("perception", {"handsel_perception_example", "--repeat", "5",
                       HANDSEL_SOURCE_DIR "/examples/perception/person.csv"});
  start("robot", {"handsel", "up", "--headless", "--scenario", "give_mug_external"});

  Session session(kDomain);
  const Snapshot& now = session.snapshot();
  ASSERT_TRUE(session.wait(from_seconds(15), [&] { return not_ready(now).empty(); }))
      << told(now) << said("robot") << said("perception");
  const std::uint64_t task = session.new_task_id();
  ASSERT_TRUE(
      session.send({.id = task, .kind = TaskKind::give, .object = "mug", .human = "visitor"}));
  ASSERT_TRUE(session.wait(from_seconds(20), [&] { return now.ground_truth.sample.robot_moving; }))
      << told(now);
  session.listen(from_seconds(0.5));
  std::map<std::string, std::uint64_t> before;
  for (const auto& [component, health] : now.health) before[component] = health.sample.incarnation;

  hosts_->link("perception", false);
  const TimePoint cut = monotonic_now();
  const auto since = [&] { return monotonic_now() - cut; };
  const auto named = [&] {
    const std::string& reason = now.health.at("spark").sample.reason;
    return now.execution.sample.causes != 0 &&
           reason.find("body_tracker is silent") != std::string::npos;
  };
  EXPECT_TRUE(session.wait(from_seconds(1.5), [&] {
    return now.execution.sample.mode >= Mode::hold;
  })) << told(now);
  note("mode " + std::string(name(now.execution.sample.mode)) + " because of " +
       cause_names(now.execution.sample.causes) + ", " + seconds(since()) + " after the cut");
  EXPECT_TRUE(session.wait(from_seconds(1.5), named))
      << told(now) << "; spark: " << now.health.at("spark").sample.reason;
  EXPECT_TRUE(session.wait(from_seconds(1.5), [&] {
    return !now.ground_truth.sample.robot_moving;
  })) << told(now);
  note("at rest after " + seconds(since()));
  session.listen(from_seconds(2.0) - since());
  EXPECT_FALSE(now.ground_truth.sample.robot_moving);
  hosts_->link("perception", true);
  const TimePoint mended = monotonic_now();
  EXPECT_TRUE(session.wait(from_seconds(10), [&] { return now.ground_truth.sample.robot_moving; }))
      << told(now);
  note("moving again " + seconds(monotonic_now() - mended) + " after the link was back");

  EXPECT_TRUE(session.wait(from_seconds(60), [&] {
    return now.tasks.contains(task) && is_over(now.tasks.at(task).state);
  })) << told(now);
  EXPECT_EQ(now.tasks.at(task).state, TaskState::succeeded) << told(now);
  EXPECT_TRUE(handover_counts(session));
  EXPECT_FALSE(now.ground_truth.sample.dropped);
  EXPECT_EQ(now.ground_truth.sample.limit_violations, 0u);
  EXPECT_EQ(now.ground_truth.sample.ssm_violations, 0u);
  for (const auto& [component, incarnation] : before)
    EXPECT_EQ(now.health.at(component).sample.incarnation, incarnation)
        << component << " was started again";
}

TEST_F(OnHosts, who_loses_the_network_for_good_can_still_end) {
  hosts_ = std::make_unique<Hosts>(std::vector<std::string>{"operator"});
  setenv("HANDSEL_PEERS", "multicast", 1);
  const auto lose_it = [&] {
    alarm(10);
    hosts_->move_here("operator");
    {
      const Session session(kDomain);
      hosts_->unplug("operator");
    }
    _exit(0);
  };
  EXPECT_EXIT(lose_it(), testing::ExitedWithCode(0), "");
}

/// A wrong setting: the process reports it in one sentence and ends before any motion is possible.
struct Mistake {
  const char* variables;
  const char* command;
  int exit_code;
  const char* sentence;
};

class Mistakes : public testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, are_said_plainly) {
  const Mistake& mistake = GetParam();
  const Outcome outcome =
      shell(std::string("env -u CYCLONEDDS_URI -u HANDSEL_PEERS ") + mistake.variables +
            " timeout 10 " + (kPrograms / mistake.command).string());
  EXPECT_EQ(outcome.exit_code, mistake.exit_code) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr(mistake.sentence));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(
    OfADeployment, Mistakes,
    testing::Values(
        Mistake{"HANDSEL_DOMAIN=300", "handsel_spark --scenario give_mug", 2,
                "HANDSEL_DOMAIN is \"300\""},
        Mistake{"HANDSEL_DOMAIN=one", "handsel_supervisor --scenario give_mug", 2,
                "HANDSEL_DOMAIN is \"one\""},
        Mistake{"HANDSEL_DOMAIN=39", "handsel_sim --scenario give_a_mug", 3,
                "no scenario \"give_a_mug\"; there is: "},
        Mistake{"HANDSEL_DOMAIN=39 HANDSEL_PEERS=nowhere.invalid",
                "handsel_spark --scenario give_mug", 3,
                "HANDSEL_PEERS names the host \"nowhere.invalid\", which has no address"},
        Mistake{"HANDSEL_DOMAIN=39 HANDSEL_HOME=/usr", "handsel_spark --scenario give_mug", 3,
                "HANDSEL_HOME is /usr"},
        Mistake{"HANDSEL_DOMAIN=39", "handsel_bridge --scenario give_mug --config /nowhere", 3,
                "/nowhere: no such folder"}));

TEST(Mistakes, a_system_that_is_not_there_is_not_healthy) {
  const Outcome outcome = shell("env HANDSEL_DOMAIN=" + std::to_string(kDomain) + " " +
                                HANDSEL_COMMAND + " health spark --within 0.5");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out,
              testing::HasSubstr("not ready on DDS domain 39: spark (nothing received yet)"));
}

}  // namespace
}  // namespace handsel::test::hosts_test
