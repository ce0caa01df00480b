// SPDX-License-Identifier: Apache-2.0
// A whole running system as one object: the domain's lock, the processes and a passive observer.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "deploy/handsel/recording/recorder.hpp"
#include "deploy/handsel/system/kept_state.hpp"
#include "deploy/handsel/system/launcher.hpp"
#include "deploy/handsel/system/launcher_settings.hpp"
#include "deploy/handsel/system/process_watch.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "deploy/handsel/system/session.hpp"

namespace handsel {

/// Why a process is not ready, empty when it is.
std::string why_not_ready(const Snapshot&, const std::string& process);
/// Returns the components that are not there or not ready, each with the reason in parentheses.
/// Empty: the system is ready. A driver may stand in for sim. The bridge may be degraded: nothing
/// depends on it; without `with_bridge` it is not asked for.
std::vector<std::string> not_ready(const Snapshot&, bool with_bridge = true);

class System {
 public:
  /// Checks the input, takes the domain and starts every process. Throws ConfigError / MissingError
  /// before any process starts.
  explicit System(const SystemOptions& options);

  Session& session() { return session_; }     ///< of this process, on the domain of the system
  Launcher& launcher() { return launcher_; }  ///< of the processes started here
  const SystemOptions& options() const { return options_; }  ///< as given to the constructor
  /// Of this run, one <process>.log each.
  const std::filesystem::path& log_directory() const { return log_directory_; }
  /// Address of the bridge's page, with the token for commands; empty while the bridge has not
  /// said so.
  std::string web_address() const;

  /// Listens until every component started here is ready; returns the time it took, or nullopt on
  /// Ctrl-C. Throws MissingError naming what is missing when no further component has become ready
  /// within `limit`, in which time that a process waited for a processor does not count;
  /// ConfigError or MissingError when a process gave up. Once ready, no death of a process ends the
  /// system.
  std::optional<Duration> wait_ready(Duration limit);
  /// Throws ConfigError / MissingError when a process gave up.
  void require_alive() const;
  /// Listens until `done` holds or `limit` is over, or Ctrl-C; true if it held. Throws as
  /// require_alive().
  bool wait(Duration limit, const std::function<bool()>& done);

 private:
  SystemOptions options_;
  DomainLock lock_;
  std::filesystem::path log_directory_;
  LauncherSettings settings_;
  Session session_;
  Recording recording_;  // until every process has stopped
  KeptState kept_;       // until every process has stopped
  Launcher launcher_;
  ProcessWatch watch_;
};

}  // namespace handsel
