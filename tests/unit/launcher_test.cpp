#include "deploy/handsel/launcher.hpp"

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

namespace handsel {
namespace {

namespace fs = std::filesystem;

constexpr Duration kPatience = std::chrono::seconds(5);

struct LauncherTest : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("handsel-launcher-" + std::to_string(getpid()));
  fs::path fifo = folder / "fifo";
  int reports = -1;  // where scripts write their process number once they run

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
      options.processes.push_back({"box" + std::to_string(options.processes.size()), "/bin/sh", {"-c", script}});
    }
    return options;
  }
  std::string reporting(const std::string& script) const { return "echo $$ > " + fifo.string() + "; " + script; }
  /// Of the next script that runs; -1: none did in time.
  pid_t reported() const {
    std::string line;
    pollfd ready{reports, POLLIN, 0};
    for (char c = 0; poll(&ready, 1, 5000) == 1 && read(reports, &c, 1) == 1 && c != '\n';) line += c;
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
  options.stop_patience = from_seconds(0.2);
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

TEST_F(LauncherTest, a_process_that_keeps_dying_is_given_up) {
  Launcher launcher(shell({"exit 1"}));
  ASSERT_TRUE(launcher.failure(kPatience).has_value());
  EXPECT_EQ(launcher.failure()->exit_code, 3);
  EXPECT_NE(launcher.failure()->reason.find("keeps dying"), std::string::npos) << launcher.failure()->reason;
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

}  // namespace
}  // namespace handsel
