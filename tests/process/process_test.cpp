// SPDX-License-Identifier: Apache-2.0
// A component as a process: ready line, clean end, refusals with exit codes, one instance of a kind
// per domain.
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "common/bus/dds/dds_bus.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"

namespace handsel::process_test {
namespace {

const std::uint32_t kDomain = 100 + static_cast<std::uint32_t>(getpid()) % 100;

class Probe {
 public:
  explicit Probe(std::vector<std::string> options) {
    int out[2], err[2];
    if (pipe(out) != 0 || pipe(err) != 0) throw std::runtime_error("no pipe");
    options.insert(options.begin(), {HANDSEL_PROBE, "--domain", std::to_string(kDomain)});
    child_ = fork();
    if (child_ == 0) {
      dup2(out[1], 1);
      dup2(err[1], 2);
      for (const int fd : {out[0], out[1], err[0], err[1]}) close(fd);
      std::vector<char*> argv;
      for (std::string& option : options) argv.push_back(option.data());
      argv.push_back(nullptr);
      execv(HANDSEL_PROBE, argv.data());
      _exit(127);
    }
    close(out[1]);
    close(err[1]);
    out_ = out[0];
    err_ = err[0];
  }
  ~Probe() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(out_);
    close(err_);
  }
  std::string out_line() const { return line(out_); }
  std::string err_line() const { return line(err_); }
  void signal(int number) const { ::kill(child_, number); }
  /// Returns the exit code, or the negative signal that ended the process; a process that does not
  /// end by itself is killed.
  int wait() {
    const int end = static_cast<int>(syscall(SYS_pidfd_open, child_, 0));
    pollfd ended{.fd = end, .events = POLLIN, .revents = 0};
    if (poll(&ended, 1, 10'000) != 1) ::kill(child_, SIGKILL);
    close(end);
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  /// Returns the next line; ends after 10 s without a character.
  static std::string line(int fd) {
    std::string text;
    pollfd readable{.fd = fd, .events = POLLIN, .revents = 0};
    for (char c = 0; poll(&readable, 1, 10'000) == 1 && read(fd, &c, 1) == 1 && c != '\n';)
      text += c;
    return text;
  }
  pid_t child_{-1};
  int out_{-1}, err_{-1};
};

class Process : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    setenv("CYCLONEDDS_URI", "file://" HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml", 1);
  }
};

TEST_F(Process, says_when_it_is_ready_answers_and_ends_cleanly_on_sigterm) {
  const TimePoint start = DdsBus({.component = "clock", .domain = kDomain, .health = false}).now();
  Probe probe({});
  EXPECT_EQ(probe.out_line().rfind("handsel_probe ready: domain ", 0), 0u);
  DdsBus bus({.component = "tester", .domain = kDomain, .health = false});
  RecordProperty("start_ms", static_cast<int>(to_seconds(bus.now() - start) * 1e3));
  auto goals = bus.advertise<TaskGoal>();
  std::uint64_t answered = 0;
  HealthState state = HealthState::starting;
  bus.subscribe<TaskStatus>([&](const TaskStatus& m, const Receipt&) { answered = m.id; });
  bus.subscribe<ComponentHealth>(
      [&](const ComponentHealth& m, const Receipt&) { state = m.state; });
  ASSERT_TRUE(bus.run_until([&] { return goals->readers() == 1 && state == HealthState::ok; },
                            std::chrono::seconds(5)));
  TaskGoal goal;
  goal.id = 42;
  goals->publish(goal);
  EXPECT_TRUE(bus.run_until([&] { return answered == 42; }, std::chrono::seconds(5)));
  const TimePoint asked = bus.now();
  probe.signal(SIGTERM);
  EXPECT_TRUE(
      bus.run_until([&] { return state == HealthState::stopping; }, std::chrono::seconds(1)));
  EXPECT_EQ(probe.wait(), 0);
  EXPECT_LT(to_seconds(bus.now() - asked), 1.0);
}

TEST_F(Process, second_of_its_kind_refuses_to_start) {
  Probe first({});
  ASSERT_NE(first.out_line().find("ready"), std::string::npos);
  Probe second({});
  EXPECT_EQ(second.err_line(), "handsel_probe: domain " + std::to_string(kDomain) +
                                   " already has a probe; --standby starts one more");
  EXPECT_EQ(second.wait(), 2);
  Probe spare({"--standby"});
  EXPECT_NE(spare.out_line().find("ready"), std::string::npos);
  spare.signal(SIGINT);
  EXPECT_EQ(spare.wait(), 0);
}

TEST_F(Process, of_two_that_start_together_one_stays) {
  Probe a({}), b({});
  const bool a_ready = a.out_line().find("ready") != std::string::npos;
  const bool b_ready = b.out_line().find("ready") != std::string::npos;
  EXPECT_NE(a_ready, b_ready);
  EXPECT_EQ((a_ready ? b : a).wait(), 2);
}

TEST_F(Process, bad_input_is_one_sentence_and_an_exit_code) {
  Probe unknown({"--robot", "nobody"});
  EXPECT_NE(unknown.err_line().find("nobody"), std::string::npos);
  EXPECT_EQ(unknown.wait(), 3);
  Probe option({"--domain", "1000"});
  EXPECT_EQ(option.wait(), 2);
  Probe folder({"--config", "/nowhere"});
  EXPECT_NE(folder.err_line().find("/nowhere"), std::string::npos);
  EXPECT_EQ(folder.wait(), 3);
}

TEST_F(Process, killed_process_is_seen_within_its_lease) {
  DdsBus bus({.component = "tester", .domain = kDomain, .health = false});
  const auto& status =
      bus.subscribe<ComponentHealth>([](const ComponentHealth&, const Receipt&) {});
  Probe probe({});
  ASSERT_NE(probe.out_line().find("ready"), std::string::npos);
  ASSERT_TRUE(bus.run_until([&] { return status.writers == 1 && status.received > 2; },
                            std::chrono::seconds(5)));
  const TimePoint killed = bus.now();
  probe.signal(SIGKILL);
  EXPECT_TRUE(bus.run_until([&] { return status.writers_lost == 1; }, std::chrono::seconds(2)));
  EXPECT_LT(to_seconds(bus.now() - killed), 1.0);
}

}  // namespace
}  // namespace handsel::process_test
