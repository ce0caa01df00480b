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
#include "deploy/handsel/processes.hpp"

namespace handsel {

/// A process as it stands.
struct ProcessStatus {
  std::string name;
  pid_t pid{-1};   ///< -1: not running
  int restarts{};  ///< how often it was started again
};

/// Why the system cannot be kept up.
struct LaunchFailure {
  std::string process;
  std::string reason;  ///< one sentence
  int exit_code{3};    ///< 2: bad input, 3: something is missing or it keeps dying
};

struct LauncherOptions {
  std::vector<ProcessSpec> processes;
  std::filesystem::path log_directory;               ///< one <name>.log each; made when it is not there
  std::function<void(const std::string&)> on_event;  ///< one sentence for people; called on the launcher's thread; may be empty
  Duration stop_patience{from_seconds(1.0)};         ///< between SIGTERM and SIGKILL
};

/// A process that ends with 2 or 3 (bad input, something missing), or dies five times within 2 s of its start, is a failure and is not
/// started again; any other death is answered by a restart at once.
class Launcher {
 public:
  explicit Launcher(LauncherOptions);  ///< starts everything; throws MissingError when the log directory cannot be made
  ~Launcher();                         ///< stop()
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// SIGTERM to all, SIGKILL after the patience, all reaped when it returns. Harmless when called again.
  void stop();
  std::vector<ProcessStatus> processes() const;
  pid_t pid(const std::string& name) const;  ///< -1 if it does not run or is unknown
  /// Waits so long for one if there is none.
  std::optional<LaunchFailure> failure(Duration patience = {}) const;

 private:
  struct Child;
  void watch();
  void start(Child&);
  void handle_exit(Child&, int wait_status);
  void stop_children();
  void say(const std::string& sentence) const;

  LauncherOptions options_;
  mutable std::mutex mutex_;
  std::vector<Child> children_;
  std::optional<LaunchFailure> failure_;
  mutable std::condition_variable failed_;
  int wake_fd_{-1};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// $XDG_STATE_HOME/handsel, ~/.local/state/handsel, or handsel in the temporary directory.
std::filesystem::path state_directory();
/// A fresh directory for the logs of one run under state_directory(); the oldest beyond 20 are removed.
std::filesystem::path new_run_directory(int domain);

/// Does a system of this machine hold the domain's lock?
bool domain_is_held(int domain);

/// Held while a system runs on a domain of this machine: a lock file, released by the kernel when its holder ends.
class DomainLock {
 public:
  explicit DomainLock(int domain);  ///< throws ConfigError when another system of this machine holds the domain
  ~DomainLock();
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

 private:
  int fd_{-1};
};

}  // namespace handsel
