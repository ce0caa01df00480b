// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/launcher.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "common/base/errors.hpp"

namespace handsel::launcher_test {
namespace {

namespace fs = std::filesystem;

constexpr Duration kPatience = std::chrono::seconds(5);

struct LauncherTest : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("handsel-launcher-" + std::to_string(getpid()));
  fs::path fifo = folder / "fifo";
  int reports = -1;  // pipe for the process numbers of started scripts

  LauncherTest() {
    fs::create_directories(folder);
    if (mkfifo(fifo.c_str(), 0600) == 0) reports = open(fifo.c_str(), O_RDWR);
  }
  ~LauncherTest() override {
    close(reports);
    fs::remove_all(folder);
  }

  LauncherOptions shell(const std::vector<std::string>& scripts) {
    LauncherOptions options{.log_directory = folder};
    for (const std::string& script : scripts) {
      options.processes.push_back(
          {"box" + std::to_string(options.processes.size()), "/bin/sh", {"-c", script}});
    }
    return options;
  }
  std::string reporting(const std::string& script) const {
    return "echo $$ > " + fifo.string() + "; " + script;
  }
  /// Of the next script that runs; -1: none did in time.
  pid_t reported() const {
    std::string line;
    pollfd ready{reports, POLLIN, 0};
    for (char c = 0; poll(&ready, 1, 5000) == 1 && read(reports, &c, 1) == 1 && c != '\n';)
      line += c;
    return line.empty() ? -1 : std::stoi(line);
  }
  static bool is_gone(pid_t pid) { return kill(pid, 0) != 0 && errno == ESRCH; }
};

TEST_F(LauncherTest, starts_every_process_and_leaves_none_behind) {
  std::vector<pid_t> pids;
  {
    Launcher launcher(shell({reporting("exec sleep 1000"), reporting("exec sleep 1000")}));
    ASSERT_GT(reported(), 0);
    ASSERT_GT(reported(), 0);
    for (const ProcessStatus& process : launcher.processes()) pids.push_back(process.pid);
  }
  for (const pid_t pid : pids) EXPECT_TRUE(is_gone(pid)) << pid;
}

TEST_F(LauncherTest, starts_again_what_was_killed) {
  Launcher launcher(shell({reporting("exec sleep 1000")}));
  const pid_t first = reported();
  ASSERT_GT(first, 0);
  EXPECT_EQ(launcher.pid("box0"), first);
  const TimePoint begin = monotonic_now();
  kill(first, SIGKILL);
  const pid_t second = reported();
  EXPECT_LT(to_seconds(monotonic_now() - begin), 2.0);
  EXPECT_GT(second, 0);
  EXPECT_NE(second, first);
  EXPECT_EQ(launcher.pid("box0"), second);
  EXPECT_EQ(launcher.processes()[0].restarts, 1);
  EXPECT_FALSE(launcher.failure());
}

TEST_F(LauncherTest, kills_what_ignores_the_polite_request) {
  LauncherOptions options = shell({"trap '' TERM; " + reporting("while :; do sleep 1; done")});
  options.stop_timeout = from_seconds(0.2);
  Launcher launcher(std::move(options));
  const pid_t pid = reported();
  ASSERT_GT(pid, 0);
  const TimePoint begin = monotonic_now();
  launcher.stop();
  EXPECT_TRUE(is_gone(pid));
  EXPECT_LT(to_seconds(monotonic_now() - begin), 2.0);
}

TEST_F(LauncherTest, a_stopped_process_is_ended_too) {
  Launcher launcher(shell({reporting("exec sleep 1000")}));
  const pid_t pid = reported();
  ASSERT_GT(pid, 0);
  kill(pid, SIGSTOP);
  launcher.stop();
  EXPECT_TRUE(is_gone(pid));
}

TEST_F(LauncherTest, bad_input_is_a_failure_with_the_last_line_it_said) {
  Launcher launcher(shell({"echo 'wrong: line 3' >&2; exit 2"}));
  ASSERT_TRUE(launcher.failure(kPatience).has_value());
  EXPECT_EQ(launcher.failure()->exit_code, 2);
  EXPECT_EQ(launcher.failure()->reason, "box0: wrong: line 3");
}

TEST_F(LauncherTest, a_process_that_keeps_dying_is_started_again_for_ever_after_growing_waits) {
  LauncherOptions options = shell({reporting("echo 'out of luck' >&2; exit 1")});
  options.backoff = {
      .first = from_seconds(0.02), .max_wait = from_seconds(0.3), .stable_after = from_seconds(30)};
  std::vector<std::string> events;  // read only after the end of the launcher
  options.on_event = [&](const std::string& sentence) { events.push_back(sentence); };
  std::vector<double> waits;
  {
    Launcher launcher(std::move(options));
    ASSERT_GT(reported(), 0);
    TimePoint before = monotonic_now();
    for (int k = 0; k < 8; ++k) {
      ASSERT_GT(reported(), 0) << "start " << k;
      waits.push_back(to_seconds(monotonic_now() - before));
      before = monotonic_now();
    }
    EXPECT_FALSE(launcher.failure());
    EXPECT_GE(launcher.processes()[0].restarts, 8);
    EXPECT_EQ(launcher.processes()[0].why, "ended with exit code 1 (out of luck)");
  }
  EXPECT_GE(waits[3], 0.16);
  for (const double wait : waits) EXPECT_LT(wait, 1.0);
  ASSERT_GE(events.size(), 3u);
  EXPECT_EQ(events[2], "box0 ended with exit code 1 (out of luck); restart 3 in 0.1 s");
}

TEST_F(LauncherTest, once_everything_was_up_no_death_is_a_failure) {
  for (const int code : {2, 3}) {
    const fs::path second = folder / ("second" + std::to_string(code));
    Launcher launcher(shell({"if [ -e " + second.string() + " ]; then " +
                             reporting("exit " + std::to_string(code)) + "; fi; touch " +
                             second.string() + "; " + reporting("exec sleep 1000")}));
    const pid_t first = reported();
    ASSERT_GT(first, 0);
    launcher.set_ready();
    kill(first, SIGKILL);
    for (int k = 0; k < 3; ++k) ASSERT_GT(reported(), 0) << "tried again";
    EXPECT_FALSE(launcher.failure());
  }
}

TEST_F(LauncherTest, a_hung_process_is_killed_and_started_again) {
  Launcher launcher(shell({reporting("exec sleep 1000")}));
  const pid_t first = reported();
  ASSERT_GT(first, 0);
  kill(first, SIGSTOP);
  launcher.replace("box0", first + 1, "was hung");
  launcher.replace("box0", first, "was hung");
  const pid_t second = reported();
  ASSERT_GT(second, 0);
  EXPECT_NE(second, first);
  EXPECT_TRUE(is_gone(first));
  EXPECT_EQ(launcher.processes()[0].why, "was hung, killed");
}

TEST_F(LauncherTest, children_die_with_a_launcher_that_was_killed) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t keeper = fork();
  if (keeper == 0) {
    Launcher launcher(shell({reporting("exec sleep 1000")}));
    pause();
    _exit(0);
  }
  const pid_t orphan = reported();
  ASSERT_GT(orphan, 0);
  kill(keeper, SIGKILL);
  waitpid(keeper, nullptr, 0);
  int status = 0;
  EXPECT_EQ(waitpid(orphan, &status, 0), orphan);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

TEST_F(LauncherTest, a_domain_is_held_by_one_system_at_a_time) {
  const int domain = 229;
  {
    const DomainLock first(domain);
    EXPECT_THROW(DomainLock second(domain), ConfigError);
  }
  EXPECT_NO_THROW(DomainLock third(domain));
}

TEST_F(LauncherTest, a_domain_held_by_another_user_is_held) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  constexpr int domain = 228;
  const DomainLock held(domain);
  const pid_t child = fork();
  if (child == 0) _exit(setuid(65534) == 0 && domain_is_held(domain) ? 0 : 1);
  int status = 1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace handsel::launcher_test
