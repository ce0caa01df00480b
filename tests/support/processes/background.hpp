// SPDX-License-Identifier: Apache-2.0
// A command that runs in the background of a test; ended with SIGINT, like Ctrl-C.
#pragma once

#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/inotify.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace handsel::test {

class Background {
 public:
  explicit Background(std::vector<std::string> arguments) {
    static int count = 0;
    log_ = std::filesystem::temp_directory_path() /
           ("handsel-background-" + std::to_string(getpid()) + "-" + std::to_string(++count));
    out_ = log_.string() + "-out";
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    std::ofstream{log_};
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      const sched_param ordinary{};
      sched_setscheduler(0, SCHED_OTHER, &ordinary);  // independent of the scheduling of the test
      if (!std::freopen(log_.c_str(), "w", stderr) || !std::freopen(out_.c_str(), "w", stdout))
        _exit(127);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Background() {
    if (pid_ > 0) interrupt();
    std::filesystem::remove(log_);
    std::filesystem::remove(out_);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  void send(int signal) const { kill(pid_, signal); }
  /// Ends it and returns its exit code.
  int interrupt() {
    kill(pid_, SIGINT);
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  /// Waits for its end and returns its exit code; -1 when it has not ended within `seconds`.
  int wait(int seconds) {
    pollfd ended{static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)), POLLIN, 0};
    const int ready = poll(&ended, 1, 1000 * seconds);
    close(ended.fd);
    int status = 0;
    if (ready <= 0 || waitpid(pid_, &status, WNOHANG) != pid_) return -1;
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  /// Returns its output on stderr so far.
  std::string said() const { return text_of(log_); }
  /// And on stdout; also after its end.
  std::string printed() const { return text_of(out_); }
  /// Waits until its output contains `text`; false after 20 s or at its end.
  bool wait_for(const std::string& text) const {
    constexpr int kAtMost = 20000;  // max time of waiting [ms]
    pollfd awaited[] = {{inotify_init1(IN_NONBLOCK | IN_CLOEXEC), POLLIN, 0},
                        {static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)), POLLIN, 0}};
    inotify_add_watch(awaited[0].fd, log_.c_str(), IN_MODIFY);
    bool found = false, more = true;
    while (!(found = said().find(text) != std::string::npos) && more) {
      more = poll(awaited, 2, kAtMost) > 0 && awaited[1].revents == 0;
      for (char notices[4096]; read(awaited[0].fd, notices, sizeof notices) > 0;) {
      }
    }
    for (const pollfd& one : awaited) close(one.fd);
    return found || said().find(text) != std::string::npos;
  }

 private:
  static std::string text_of(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  pid_t pid_{-1};
  std::filesystem::path log_, out_;
};

}  // namespace handsel::test
