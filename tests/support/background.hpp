// A command that runs while a test does something else; ended with SIGINT, as Ctrl-C would.
#pragma once

#include <signal.h>
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
    log_ = std::filesystem::temp_directory_path() / ("handsel-background-" + std::to_string(getpid()));
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      if (!std::freopen(log_.c_str(), "w", stderr) || !std::freopen("/dev/null", "w", stdout)) _exit(127);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Background() {
    if (pid_ > 0) interrupt();
    std::filesystem::remove(log_);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// Ends it and returns its exit code.
  int interrupt() {
    kill(pid_, SIGINT);
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  /// What it has said on stderr so far.
  std::string said() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }
  /// Waits until it has said `text`; false after 20 s or when it ended.
  bool wait_for(const std::string& text) const {
    for (int i = 0; i < 2000; ++i) {
      if (said().find(text) != std::string::npos) return true;
      if (waitpid(pid_, nullptr, WNOHANG) != 0) return false;
      usleep(10000);
    }
    return false;
  }

 private:
  pid_t pid_{-1};
  std::filesystem::path log_;
};

}  // namespace handsel::test
