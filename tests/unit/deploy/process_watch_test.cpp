// SPDX-License-Identifier: Apache-2.0
// The process watch of the launcher: processes without heartbeats are replaced, and their health is
// reported on their behalf while they do not run.
#include "deploy/handsel/system/process_watch.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/executor.hpp"
#include "common/config/resources.hpp"
#include "deploy/handsel/system/launcher_settings.hpp"

namespace handsel::process_watch_test {
namespace {

namespace fs = std::filesystem;

/// Scripts as processes; the test beats for those that are not silent.
struct Watched : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("handsel-watch-" + std::to_string(getpid()));
  DdsBus bus{{.component = "watch", .domain = 227, .health = false}};
  std::unique_ptr<Publisher<ComponentHealth>> beats = bus.advertise<ComponentHealth>();
  LivenessSettings settings{.hung_after = from_seconds(0.6),
                            .silent_job_after = from_seconds(1.0),
                            .start_timeout = from_seconds(5.0)};
  std::unique_ptr<Launcher> launcher;
  std::unique_ptr<ProcessWatch> watch;
  bool silent{};
  std::set<std::string> silent_ones;
  bool job_silent{};                    // in the heartbeats
  std::string reason;                   // in the heartbeats
  std::optional<ComponentHealth> said;  // reported on behalf of the process

  void start(const std::string& script, BackoffSettings backoff = {},
             const std::vector<std::string>& names = {"box"}) {
    bus.every(from_seconds(0.1), [this](TimePoint) { beat(); });
    bus.subscribe<ComponentHealth>([this](const ComponentHealth& health, const Receipt&) {
      if (health.state == HealthState::stopping) said = health;
    });
    LauncherOptions options{.log_directory = folder, .backoff = backoff};
    for (const std::string& one : names)
      options.processes.push_back({one, "/bin/sh", {"-c", script}});
    launcher = std::make_unique<Launcher>(std::move(options));
    watch = std::make_unique<ProcessWatch>(bus, *launcher, settings);
    ASSERT_TRUE(until(5.0, [this] { return launcher->pid("box") > 0; }));
  }
  void beat() {
    if (silent || !launcher) return;
    for (const ProcessStatus& process : launcher->processes()) {
      if (process.pid <= 0 || silent_ones.count(process.name) > 0) continue;
      ComponentHealth health;
      health.component = process.name;
      health.pid = static_cast<std::uint32_t>(process.pid);
      health.state = HealthState::ok;
      health.reason = reason;
      health.job_silent = job_silent;
      beats->publish(health);
    }
  }
  bool until(double limit, const std::function<bool()>& done) {
    return bus.run_until(done, from_seconds(limit));
  }
  ~Watched() override {
    launcher.reset();
    fs::remove_all(folder);
  }
};

TEST_F(Watched, a_stopped_process_without_heartbeats_is_replaced) {
  start("exec sleep 1000", {.first = from_seconds(1.0)});
  until(1.5, [] { return false; });
  const pid_t first = launcher->pid("box");
  EXPECT_EQ(launcher->processes()[0].restarts, 0) << "with heartbeats nobody is killed";
  kill(first, SIGSTOP);
  silent = true;
  ASSERT_TRUE(until(5.0, [&] { return said.has_value(); }));
  EXPECT_EQ(said->component, "box");
  EXPECT_EQ(said->pid, 0u);
  EXPECT_NE(
      said->reason.find("it was hung, stopped and without heartbeat for more than 0.6 s, killed"),
      std::string::npos)
      << said->reason;
  EXPECT_EQ(said->reason.find("restart 1 in "), 0u) << said->reason;
  silent = false;
  ASSERT_TRUE(
      until(5.0, [&] { return launcher->pid("box") > 0 && launcher->pid("box") != first; }));
  until(1.0, [] { return false; });
  EXPECT_EQ(launcher->processes()[0].restarts, 1) << "the new one is left alone";
}

TEST_F(Watched, a_process_that_waits_for_ever_is_replaced_though_nobody_stopped_it) {
  start("exec sleep 1000");
  until(0.5, [] { return false; });
  silent = true;
  EXPECT_TRUE(until(5.0, [&] { return launcher->processes()[0].restarts == 1; }));
}

TEST_F(Watched, when_everybody_is_silent_at_once_the_listener_is_deaf_and_kills_nobody) {
  start("exec sleep 1000", {}, {"box", "other"});
  until(0.5, [] { return false; });
  silent = true;
  until(3.0, [] { return false; });
  for (const ProcessStatus& process : launcher->processes())
    EXPECT_EQ(process.restarts, 0) << process.name;
}

TEST_F(Watched, when_most_are_silent_at_once_the_machine_is_at_fault_and_nobody_is_killed) {
  start("exec sleep 1000", {}, {"box", "second", "third", "fourth", "fifth"});
  until(0.5, [] { return false; });
  silent_ones = {"box", "second", "third"};
  until(3.0, [] { return false; });
  for (const ProcessStatus& one : launcher->processes()) EXPECT_EQ(one.restarts, 0) << one.name;
  silent_ones = {"box", "second"};
  const auto replaced = [&] { return launcher->processes()[0].restarts == 1; };
  EXPECT_TRUE(until(5.0, replaced)) << "two of five are replaced";
}

TEST_F(Watched, a_process_whose_job_is_silent_for_long_is_replaced_though_it_beats) {
  start("exec sleep 1000");
  until(0.5, [] { return false; });
  reason = "something else";
  until(1.5, [] { return false; });
  EXPECT_EQ(launcher->processes()[0].restarts, 0);
  job_silent = true;
  ASSERT_TRUE(until(5.0, [&] { return launcher->processes()[0].restarts == 1; }));
  EXPECT_NE(
      launcher->processes()[0].why.find("a job has given no sign of life for more than 1.0 s"),
      std::string::npos)
      << launcher->processes()[0].why;
}

TEST(LauncherSettings, are_read_and_each_bad_value_is_refused_with_file_line_and_key) {
  const LauncherSettings shipped = load_launcher_settings(resource("config/launcher.txtpb"));
  EXPECT_EQ(shipped.liveness.hung_after, from_seconds(2.0));
  EXPECT_EQ(shipped.backoff.max_wait, from_seconds(10.0));
  const fs::path file =
      fs::temp_directory_path() / ("launcher-" + std::to_string(getpid()) + ".txtpb");
  const std::vector<std::string> keys{"hung_after",    "silent_job_after", "start_timeout",
                                      "first_backoff", "max_backoff",      "stable_after"};
  for (const std::string& wrong : keys) {
    for (const std::string value : {"nan", "inf", "-1", "0", "1e9"}) {
      std::string text;
      for (const std::string& key : keys)
        text += key + ": " + (key == wrong ? value : "5.0") + "\n";
      std::ofstream(file) << text;
      try {
        load_launcher_settings(file);
        ADD_FAILURE() << wrong << " " << value << " was taken";
      } catch (const ConfigError& error) {
        EXPECT_NE(std::string(error.what()).find(wrong), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
      }
    }
  }
  fs::remove(file);
}

}  // namespace
}  // namespace handsel::process_watch_test
