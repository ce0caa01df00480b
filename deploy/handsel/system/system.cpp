// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/system.hpp"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/wire/interface_id.hpp"
#include "deploy/handsel/system/proc_stat.hpp"
#include "deploy/handsel/system/status.hpp"

namespace handsel {
namespace {

constexpr Duration kStarvedCheck = std::chrono::milliseconds(200);

/// Returns HANDSEL_WEB_TOKEN (empty if it is "none"), which then leaves the environment so that
/// only the bridge receives it; else 128 random bits in hexadecimal digits.
std::string page_token() {
  constexpr const char* kVariable = "HANDSEL_WEB_TOKEN";
  if (const char* given = std::getenv(kVariable); given != nullptr && *given != '\0') {
    std::string token = given;
    unsetenv(kVariable);
    return token == "none" ? "" : token;
  }
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw MissingError("the system gives no random numbers for the token of the page");
  constexpr const char* kDigits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) token.append({kDigits[byte >> 4U], kDigits[byte & 15U]});
  return token;
}

SystemOptions checked(SystemOptions options) {
  check_system(options);
  system_processes(options);
  if (options.web_port >= 0)
    setenv("HANDSEL_WEB_PORT", std::to_string(options.web_port).c_str(), 1);
  // Large pages: reading meshes fills buffers of 16 MB; page by page this takes a third of the
  // start.
  setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
  options.web_token = page_token();
  return options;
}

LauncherOptions launcher_options(const SystemOptions& options,
                                 const std::filesystem::path& log_directory,
                                 const LauncherSettings& settings) {
  return {.processes = system_processes(options),
          .log_directory = log_directory,
          .on_event =
              [](const std::string& sentence) {
                std::fprintf(stderr, "handsel: %s\n", sentence.c_str());
              },
          .backoff = settings.backoff};
}

mcap::Metadata record_notes(const SystemOptions& options) {
  mcap::Metadata notes = options.notes;
  notes["robot"] = robot_of(options);
  notes["scenario"] = options.scenario;
  notes["seed"] = std::to_string(options.seed);
  notes["domain"] = std::to_string(options.domain);
  notes["version"] = version_text();
  return notes;
}

std::string join(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text;
}

}  // namespace

std::string why_not_ready(const Snapshot& snapshot, const std::string& process) {
  const auto found = snapshot.health.find(process);
  if (found == snapshot.health.end()) return "nothing received yet";
  const ComponentHealth& health = found->second.sample;
  const bool enough = health.state == HealthState::ok ||
                      (process == "bridge" && health.state == HealthState::degraded);
  return enough ? "" : health.reason.empty() ? "starting" : health.reason;
}

std::vector<std::string> not_ready(const Snapshot& snapshot, bool with_bridge) {
  std::vector<std::string> missing;
  for (const std::string process : kProcesses) {
    if (process == "bridge" && !with_bridge) continue;
    const std::string component = process == "sim" ? robot_side(snapshot) : process;
    const std::string why = why_not_ready(snapshot, component);
    if (!why.empty()) missing.push_back(component + " (" + why + ")");
  }
  return missing;
}

System::System(const SystemOptions& options)
    : options_(checked(options)),
      lock_(options_.domain),
      log_directory_(new_run_directory(options_.domain)),
      settings_(load_launcher_settings(resource("config/launcher.txtpb"))),
      session_(options_.domain),
      recording_(session_.bus(), options_.record, record_notes(options_)),
      kept_(state_folder(options_)),
      launcher_(launcher_options(options_, log_directory_, settings_)),
      watch_(session_.bus(), launcher_, settings_.liveness) {}

void System::require_alive() const {
  const auto failure = launcher_.failure();
  if (!failure) return;
  if (failure->exit_code == 2) throw ConfigError(failure->reason);
  throw MissingError(failure->reason);
}

bool System::wait(Duration limit, const std::function<bool()>& done) {
  bool failed = false, held = false;
  session_.wait(limit, [&] {
    failed = launcher_.failure().has_value();
    held = !failed && done();
    return failed || held;
  });
  if (failed) require_alive();
  return held;
}

std::optional<Duration> System::wait_ready(Duration limit) {
  const TimePoint begin = monotonic_now();
  const auto lacking = [this] {
    std::vector<std::string> missing;
    for (const ProcessStatus& process : launcher_.processes()) {
      const std::string why = why_not_ready(session_.snapshot(), process.name);
      if (!why.empty()) missing.push_back(process.name + " (" + why + ")");
    }
    return missing;
  };
  // Time in which a process waits for a processor does not count, and the limit restarts with every
  // process that becomes ready: of two systems on one processor each starts more slowly.
  std::map<std::string, ThreadDelay> delays;
  const auto starved = [&] {
    Duration max_delay{};
    for (const ProcessStatus& process : launcher_.processes())
      if (process.pid > 0)
        max_delay = std::max(max_delay, delays[process.name].update(process.pid));
    return max_delay;
  };
  std::size_t fewest = lacking().size();
  TimePoint end = begin + limit;
  while (!interrupted() && monotonic_now() < end + starved()) {
    if (wait(kStarvedCheck, [&] { return lacking().empty(); })) {
      launcher_.set_ready();
      return monotonic_now() - begin;
    }
    if (const std::size_t now = lacking().size(); now < fewest) {
      fewest = now;
      end = monotonic_now() - starved() + limit;
    }
  }
  if (interrupted()) return std::nullopt;
  throw MissingError("the system is not ready after " +
                     std::to_string(static_cast<int>(to_seconds(monotonic_now() - begin))) +
                     " s; waiting for " + join(lacking()) + "; logs are in " +
                     log_directory_.string());
}

std::string System::web_address() const {
  const auto bridge = session_.snapshot().health.find("bridge");
  if (bridge == session_.snapshot().health.end()) return {};
  std::FILE* file = std::fopen((log_directory_ / "bridge.log").c_str(), "r");
  if (!file) return {};
  char line[512];
  std::string address;
  while (std::fgets(line, sizeof line, file)) {
    const std::string text = line;
    if (const auto at = text.find("http://127.0.0.1:"); at != std::string::npos)
      address = text.substr(at, text.find_first_of(" \n", at) - at);
  }
  std::fclose(file);
  return address.empty() || options_.web_token.empty() ? address
                                                       : address + "#token=" + options_.web_token;
}

}  // namespace handsel
