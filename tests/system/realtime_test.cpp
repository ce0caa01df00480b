// SPDX-License-Identifier: Apache-2.0
// The controller's thread: real-time scheduling and locked memory where permitted, else a clear
// message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/capability.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <string>

namespace {

using testing::HasSubstr;

struct Started {
  std::string says;  // its ready line
  int policy{};
  long locked_kb{};
};

Started start(const std::function<void()>& before) {
  int out[2];
  if (pipe(out) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    dup2(out[1], STDOUT_FILENO);
    before();
    execl(HANDSEL_CONTROLLER, HANDSEL_CONTROLLER, "--realtime", "--domain", "218", nullptr);
    std::_Exit(127);
  }
  close(out[1]);
  Started started;
  char letter = 0;
  while (read(out[0], &letter, 1) == 1 && letter != '\n') started.says += letter;
  started.policy = sched_getscheduler(child);
  std::ifstream status("/proc/" + std::to_string(child) + "/status");
  for (std::string word; status >> word;)
    if (word == "VmLck:") status >> started.locked_kb;
  kill(child, SIGTERM);
  waitpid(child, nullptr, 0);
  close(out[0]);
  return started;
}

TEST(Realtime, is_taken_where_permitted) {
  sched_param urgent{};
  urgent.sched_priority = 1;
  const pid_t trial = fork();
  if (trial == 0) std::_Exit(sched_setscheduler(0, SCHED_FIFO, &urgent) == 0 ? 0 : 1);
  int refused = 0;
  waitpid(trial, &refused, 0);
  if (refused != 0) GTEST_SKIP() << "SCHED_FIFO is not permitted here";
  const Started started = start([] {});
  EXPECT_THAT(started.says, HasSubstr("real time"));
  EXPECT_EQ(started.policy, SCHED_FIFO);
  EXPECT_TRUE(started.locked_kb > 1000 ||
              started.says.find("cannot be locked") != std::string::npos)
      << started.locked_kb;
}

TEST(Realtime, says_so_when_it_is_not_permitted) {
  const Started started = start([] {
    prctl(PR_CAPBSET_DROP, CAP_SYS_NICE);
    prctl(PR_CAPBSET_DROP, CAP_IPC_LOCK);
    const rlimit none{0, 0};
    setrlimit(RLIMIT_RTPRIO, &none);
    setrlimit(RLIMIT_MEMLOCK, &none);
  });
  EXPECT_THAT(started.says, HasSubstr("not real time: SCHED_FIFO is not permitted"));
  EXPECT_THAT(started.says, HasSubstr("memory cannot be locked"));
  EXPECT_EQ(started.policy, SCHED_OTHER);
  EXPECT_EQ(started.locked_kb, 0);
}

}  // namespace
