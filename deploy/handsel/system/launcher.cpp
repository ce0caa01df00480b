// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/launcher.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "common/base/errors.hpp"
#include "common/bus/dds/dds_defaults.hpp"

extern char** environ;

namespace handsel {
namespace {

constexpr std::size_t kKeptRuns = 20;

std::string describe_exit(int status) {
  if (WIFSIGNALED(status))
    return "was ended by signal " + std::to_string(WTERMSIG(status)) + " (" +
           strsignal(WTERMSIG(status)) + ")";
  return "ended with exit code " + std::to_string(WEXITSTATUS(status));
}

std::string last_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line)) {
    if (!line.empty()) last = line;
  }
  return last;
}

}  // namespace

struct Launcher::Child {
  ProcessSpec spec;
  pid_t pid{-1};
  int pid_fd{-1};
  int starts{0};
  Backoff backoff;
  TimePoint since{};               // time of the start or the end
  std::string hung{};              // reason of the kill
  std::string why{};               // reason of the end
  std::optional<TimePoint> due{};  // time of the restart
};

Launcher::Launcher(LauncherOptions options) : options_(std::move(options)) {
  std::error_code error;
  std::filesystem::create_directories(options_.log_directory, error);
  if (error)
    throw MissingError("cannot make the log directory " + options_.log_directory.string() + ": " +
                       error.message());
  for (const ProcessSpec& spec : options_.processes)
    children_.push_back({.spec = spec, .backoff = Backoff(options_.backoff)});
  wake_fd_ = eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { watch(); });
}

Launcher::~Launcher() {
  stop();
  close(wake_fd_);
}

void Launcher::stop() {
  stopping_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(wake_fd_, &one, sizeof one);
  if (thread_.joinable()) thread_.join();
}

// The parent-death signal follows the forking thread: this thread starts every child and lives as
// long as they do.
void Launcher::watch() {
  {
    std::lock_guard lock(mutex_);
    for (Child& child : children_) start(child);
  }
  while (!stopping_) {
    std::vector<pollfd> fds{{wake_fd_, POLLIN, 0}};
    for (const Child& child : children_) {
      if (child.pid_fd >= 0) fds.push_back({child.pid_fd, POLLIN, 0});
    }
    poll(fds.data(), fds.size(), poll_time());
    std::lock_guard lock(mutex_);
    for (Child& child : children_) {
      int status = 0;
      if (stopping_ || child.pid < 0 || waitpid(child.pid, &status, WNOHANG) != child.pid) continue;
      handle_exit(child, status);
    }
    if (!stopping_) start_due();
  }
  stop_children();
}

/// Returns the time until the next start [ms].
int Launcher::poll_time() const {
  constexpr Duration kMaxWait = std::chrono::seconds(1);
  Duration left = kMaxWait;
  for (const Child& child : children_)
    if (child.due) left = std::min(left, *child.due - monotonic_now());
  return static_cast<int>(std::max(left, Duration{}) / std::chrono::milliseconds(1)) + 1;
}

void Launcher::start_due() {
  for (Child& child : children_) {
    if (!child.due || *child.due > monotonic_now()) continue;
    child.due.reset();
    start(child);
  }
}

void Launcher::start(Child& child) {
  std::vector<char*> arguments{const_cast<char*>(child.spec.binary.c_str())};
  for (const std::string& argument : child.spec.arguments)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  // Of two entries of one name the first counts.
  std::vector<char*> environment;
  for (const std::string& variable : child.spec.environment)
    environment.push_back(const_cast<char*>(variable.c_str()));
  for (char** variable = environ; *variable != nullptr; ++variable)
    environment.push_back(*variable);
  environment.push_back(nullptr);
  const std::string log = (options_.log_directory / (child.spec.name + ".log")).string();
  const pid_t launcher = getpid();

  const pid_t pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != launcher) _exit(3);
    setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    const int in = open("/dev/null", O_RDONLY);
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execve(arguments[0], arguments.data(), environment.data());
    _exit(3);
  }
  child.since = monotonic_now();
  if (pid < 0) {
    const std::string why = std::string("cannot be started: ") + std::strerror(errno);
    if (!ready_) return fail(child, child.spec.name + " " + why, 3);
    child.why = why;
    child.due = child.since + child.backoff.after_life_of({});
    return;
  }
  child.pid = pid;
  child.pid_fd = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  ++child.starts;
}

void Launcher::fail(const Child& child, const std::string& reason, int exit_code) {
  failure_ = LaunchFailure{child.spec.name, reason, exit_code};
  failed_.notify_all();
}

void Launcher::handle_exit(Child& child, int status) {
  close(child.pid_fd);
  child.pid = child.pid_fd = -1;
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  const TimePoint now = monotonic_now();
  const Duration wait = child.backoff.after_life_of(now - child.since);
  child.since = now;
  child.why = child.hung.empty() ? describe_exit(status) : child.hung + ", killed";
  child.hung.clear();
  if (code != 0) {
    const std::string said = last_line(options_.log_directory / (child.spec.name + ".log"));
    if (!ready_ && (code == 2 || code == 3))
      return fail(child, child.spec.name + ": " + (said.empty() ? describe_exit(status) : said),
                  code);
    if (!said.empty()) child.why += " (" + said + ")";
  }
  child.due = now + wait;
  char when[32];
  std::snprintf(when, sizeof when, "%.1f s", to_seconds(wait));
  say(child.spec.name + " " + child.why + "; restart " + std::to_string(child.starts) + " in " +
      when);
}

void Launcher::replace(const std::string& name, pid_t pid, const std::string& why) {
  std::lock_guard lock(mutex_);
  for (Child& child : children_) {
    if (child.spec.name != name || child.pid != pid || pid <= 0 || stopping_) continue;
    child.hung = why;
    kill(pid, SIGKILL);
  }
}

void Launcher::stop_children() {
  std::lock_guard lock(mutex_);
  for (const Child& child : children_) {
    if (child.pid > 0) {
      kill(child.pid, SIGTERM);
      kill(child.pid, SIGCONT);
    }
  }
  const TimePoint deadline = monotonic_now() + options_.stop_timeout;
  for (Child& child : children_) {
    if (child.pid < 0) continue;
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - monotonic_now()).count();
    pollfd fd{child.pid_fd, POLLIN, 0};
    if (poll(&fd, 1, static_cast<int>(std::max<long>(left, 0))) == 0) {
      kill(child.pid, SIGKILL);
      say(child.spec.name + " did not stop in time and was killed");
    }
    waitpid(child.pid, nullptr, 0);
    close(child.pid_fd);
    child.pid = child.pid_fd = -1;
  }
}

void Launcher::say(const std::string& sentence) const {
  if (options_.on_event) options_.on_event(sentence);
}

std::vector<ProcessStatus> Launcher::processes() const {
  std::lock_guard lock(mutex_);
  const auto wait_of = [](const Child& child) {
    return child.due ? std::max(Duration{}, *child.due - monotonic_now()) : Duration{};
  };
  std::vector<ProcessStatus> result;
  for (const Child& child : children_)
    result.push_back({child.spec.name, child.pid, std::max(child.starts - 1, 0), child.since,
                      child.why, wait_of(child)});
  return result;
}

pid_t Launcher::pid(const std::string& name) const {
  std::lock_guard lock(mutex_);
  const auto child = std::find_if(children_.begin(), children_.end(),
                                  [&](const Child& c) { return c.spec.name == name; });
  return child == children_.end() ? -1 : child->pid;
}

std::optional<LaunchFailure> Launcher::failure(Duration timeout) const {
  std::unique_lock lock(mutex_);
  failed_.wait_for(lock, timeout, [this] { return failure_.has_value(); });
  return failure_;
}

std::filesystem::path new_run_directory(int domain) {
  namespace fs = std::filesystem;
  const fs::path root = state_directory() / "runs";
  std::error_code ignored;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(root, ignored)) old.push_back(entry.path());
  std::sort(old.begin(), old.end());
  for (std::size_t i = 0; i + kKeptRuns <= old.size(); ++i) fs::remove_all(old[i], ignored);
  char when[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(when, sizeof when, "%Y%m%d-%H%M%S", std::localtime(&now));
  return root /
         (std::string(when) + "-domain" + std::to_string(domain) + "-" + std::to_string(getpid()));
}

namespace {

std::filesystem::path lock_file(int domain) {
  const std::string name = system_name();
  return std::filesystem::temp_directory_path() /
         ("handsel-domain-" + std::to_string(domain) + (name.empty() ? "" : "-" + name) + ".lock");
}

}  // namespace

bool domain_is_held(int domain) {
  const int fd = open(lock_file(domain).c_str(), O_RDONLY | O_CLOEXEC);  // maybe of another user
  if (fd < 0) return false;
  const bool held = flock(fd, LOCK_SH | LOCK_NB) != 0;
  close(fd);
  return held;
}

DomainLock::DomainLock(int domain) {
  const std::filesystem::path file = lock_file(domain);
  fd_ = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) fd_ = open(file.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) throw MissingError("cannot open " + file.string() + ": " + std::strerror(errno));
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    close(fd_);
    throw ConfigError("DDS domain " + std::to_string(domain) +
                      " is in use by another system on this machine; choose another with --domain, "
                      "or let both robots work in it with --name");
  }
}

DomainLock::~DomainLock() { close(fd_); }

}  // namespace handsel
