// SPDX-License-Identifier: Apache-2.0
// Starts processes, restarts what dies, stops them all. Children never outlive it, however it ends.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/time.hpp"
#include "common/bus/executor.hpp"
#include "common/bus/state_directory.hpp"
#include "deploy/handsel/system/liveness.hpp"
#include "deploy/handsel/system/processes.hpp"

namespace handsel {

/// A process as it stands.
struct ProcessStatus {
  std::string name;   ///< as in ProcessSpec
  pid_t pid{-1};      ///< -1: not running
  int restarts{};     ///< how often it was started again
  TimePoint since{};  ///< started, or ended
  std::string why;    ///< how it ended last, e.g. "ended with exit code 1"; empty: never
  Duration wait{};    ///< while it does not run: until it is started again
};

/// Why the system cannot be kept up.
struct LaunchFailure {
  std::string process;  ///< name of the process that failed
  std::string reason;   ///< one sentence
  int exit_code{3};     ///< 2: bad input, 3: something is missing
};

struct LauncherOptions {
  std::vector<ProcessSpec> processes;   ///< to start and keep alive, in this order
  std::filesystem::path log_directory;  ///< one <name>.log each; made when it is not there
  /// One sentence for people; called on the launcher's thread; may be empty.
  std::function<void(const std::string&)> on_event;
  Duration stop_timeout{from_seconds(1.0)};  ///< between SIGTERM and SIGKILL
  BackoffSettings backoff{};                 ///< between a death and the next start
};

/// A process that ends is started again, after a wait that grows with each death; for ever. Only
/// before set_ready() an end with 2 or 3 (bad input, something missing) is a failure, and that
/// process is not started again.
class Launcher {
 public:
  /// Starts everything; throws MissingError when the log directory cannot be made.
  explicit Launcher(LauncherOptions);
  ~Launcher();  ///< stop()
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// Everything has been up: from now on no death is a failure.
  void set_ready() { ready_ = true; }
  /// Kills a process that is hung, when it is still the one with this pid; it is then started
  /// again. `why`: e.g. "hung: no heartbeat ...".
  void replace(const std::string& name, pid_t pid, const std::string& why);
  /// Sends SIGTERM to all, SIGKILL after `stop_timeout`; all are reaped when stop() returns.
  /// Harmless when called again.
  void stop();
  std::vector<ProcessStatus> processes() const;  ///< state of each now, in the order of the options
  pid_t pid(const std::string& name) const;      ///< -1 if it does not run or is unknown
  /// Returns the failure, waiting for one up to the given time; nullopt when there is none.
  std::optional<LaunchFailure> failure(Duration timeout = {}) const;

 private:
  struct Child;
  void watch();
  void start(Child&);
  void start_due();
  int poll_time() const;
  void handle_exit(Child&, int wait_status);
  void fail(const Child&, const std::string& reason, int exit_code);
  void stop_children();
  void say(const std::string& sentence) const;

  LauncherOptions options_;
  mutable std::mutex mutex_;
  std::vector<Child> children_;
  std::optional<LaunchFailure> failure_;
  mutable std::condition_variable failed_;
  int wake_fd_{-1};
  std::atomic<bool> stopping_{false}, ready_{false};
  std::thread thread_;
};

/// A fresh directory for the logs of one run under state_directory(); the oldest beyond 20 are
/// removed.
std::filesystem::path new_run_directory(int domain);

/// Does a system of this machine hold the domain's lock?
bool domain_is_held(int domain);

/// Held while a system runs on a domain of this machine: a lock file, released by the kernel when
/// its holder ends.
class DomainLock {
 public:
  /// Throws ConfigError when another system of this machine holds the domain.
  explicit DomainLock(int domain);
  ~DomainLock();
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

 private:
  int fd_{-1};
};

}  // namespace handsel
