#include "deploy/handsel/launcher.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

namespace fs = std::filesystem;

struct LauncherTest : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("handsel-launcher-" + std::to_string(getpid()));
  ~LauncherTest() override { fs::remove_all(folder); }

  LauncherOptions shell(const std::vector<std::string>& scripts) {
    LauncherOptions options{.log_directory = folder};
    for (const std::string& script : scripts) {
      options.processes.push_back({"box" + std::to_string(options.processes.size()), "/bin/sh", {"-c", script}});
    }
    return options;
  }
  static bool eventually(const std::function<bool()>& condition, double limit = 5.0) {
    const TimePoint end = monotonic_now() + from_seconds(limit);
    while (!condition()) {
      if (monotonic_now() > end) return false;
      usleep(1000);
    }
    return true;
  }
  static bool is_gone(pid_t pid) { return kill(pid, 0) != 0 && errno == ESRCH; }
};

TEST_F(LauncherTest, starts_every_process_and_leaves_none_behind) {
  std::vector<pid_t> pids;
  {
    Launcher launcher(shell({"exec sleep 1000", "exec sleep 1000"}));
    ASSERT_TRUE(eventually([&] { return launcher.pid("box0") > 0 && launcher.pid("box1") > 0; }));
    for (const ProcessStatus& process : launcher.processes()) pids.push_back(process.pid);
  }
  for (const pid_t pid : pids) EXPECT_TRUE(is_gone(pid)) << pid;
}

TEST_F(LauncherTest, starts_again_what_was_killed) {
  Launcher launcher(shell({"exec sleep 1000"}));
  ASSERT_TRUE(eventually([&] { return launcher.pid("box0") > 0; }));
  const pid_t first = launcher.pid("box0");
  kill(first, SIGKILL);
  EXPECT_TRUE(eventually([&] { return launcher.pid("box0") > 0 && launcher.pid("box0") != first; }, 2.0));
  EXPECT_EQ(launcher.processes()[0].restarts, 1);
  EXPECT_FALSE(launcher.failure());
}

TEST_F(LauncherTest, kills_what_ignores_the_polite_request) {
  LauncherOptions options = shell({"trap '' TERM; echo ready; while :; do sleep 1; done"});
  options.stop_patience = from_seconds(0.2);
  Launcher launcher(std::move(options));
  ASSERT_TRUE(eventually([&] { return fs::exists(folder / "box0.log") && fs::file_size(folder / "box0.log") > 0; }));
  const pid_t pid = launcher.pid("box0");
  const TimePoint begin = monotonic_now();
  launcher.stop();
  EXPECT_TRUE(is_gone(pid));
  EXPECT_LT(to_seconds(monotonic_now() - begin), 2.0);
}

TEST_F(LauncherTest, a_stopped_process_is_ended_too) {
  Launcher launcher(shell({"exec sleep 1000"}));
  ASSERT_TRUE(eventually([&] { return launcher.pid("box0") > 0; }));
  const pid_t pid = launcher.pid("box0");
  kill(pid, SIGSTOP);
  launcher.stop();
  EXPECT_TRUE(is_gone(pid));
}

TEST_F(LauncherTest, bad_input_is_a_failure_with_the_last_line_it_said) {
  Launcher launcher(shell({"echo 'wrong: line 3' >&2; exit 2"}));
  ASSERT_TRUE(eventually([&] { return launcher.failure().has_value(); }));
  EXPECT_EQ(launcher.failure()->exit_code, 2);
  EXPECT_EQ(launcher.failure()->reason, "box0: wrong: line 3");
}

TEST_F(LauncherTest, a_process_that_keeps_dying_is_given_up) {
  Launcher launcher(shell({"exit 1"}));
  ASSERT_TRUE(eventually([&] { return launcher.failure().has_value(); }));
  EXPECT_EQ(launcher.failure()->exit_code, 3);
  EXPECT_NE(launcher.failure()->reason.find("keeps dying"), std::string::npos) << launcher.failure()->reason;
}

TEST_F(LauncherTest, children_die_with_a_launcher_that_was_killed) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  int channel[2];
  ASSERT_EQ(pipe(channel), 0);
  const pid_t keeper = fork();
  if (keeper == 0) {
    Launcher launcher(shell({"exec sleep 1000"}));
    eventually([&] { return launcher.pid("box0") > 0; });
    const pid_t pid = launcher.pid("box0");
    if (write(channel[1], &pid, sizeof pid) != sizeof pid) _exit(1);
    pause();
    _exit(0);
  }
  pid_t orphan = -1;
  ASSERT_EQ(read(channel[0], &orphan, sizeof orphan), static_cast<ssize_t>(sizeof orphan));
  EXPECT_TRUE(eventually([&] {  // what was to run does: before that a child without a launcher ends by itself
    std::string program;
    std::ifstream("/proc/" + std::to_string(orphan) + "/comm") >> program;
    return program == "sleep";
  }));
  kill(keeper, SIGKILL);
  waitpid(keeper, nullptr, 0);
  int status = 0;
  EXPECT_TRUE(eventually([&] { return waitpid(orphan, &status, WNOHANG) == orphan; }));
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
