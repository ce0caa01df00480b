// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.hpp"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <CLI/CLI.hpp>

#include "common/base/errors.hpp"
#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/dds/dds_defaults.hpp"
#include "common/bus/state_directory.hpp"
#include "common/config/overlay.hpp"
#include "common/config/search_path.hpp"
#include "common/messages/system.hpp"
#include "common/wire/interface_id.hpp"

namespace handsel {
namespace {

constexpr Duration kTwinWait = std::chrono::milliseconds(400);

constexpr Duration kJobsEnd = std::chrono::milliseconds(600);
constexpr useconds_t kMaxEndTime = 950'000;  // max time from the decision to end until the end [us]

std::atomic<DdsBus*> stopped_by_signal{nullptr};
std::atomic<bool> asked_to_end{false};

/// Exit code of a process that does not end in time.
std::atomic<int> late_exit_code{0};

/// Ends the process with `code` if it does not end by itself within `kMaxEndTime`: the transport
/// waits without limit for a network that has vanished. From now on signals do not stop the bus.
/// Only the first call has an effect.
void require_end(int code) {
  static std::atomic<bool> required{false};
  if (required.exchange(true)) return;
  stopped_by_signal = nullptr;
  late_exit_code = code;
  signal(SIGALRM, [](int) { _exit(late_exit_code); });
  ualarm(kMaxEndTime, 0);
}

/// Requires the end of the process when a scope ends, also after an exception.
struct EndRequired {
  ~EndRequired() { require_end(std::uncaught_exceptions() > 0 ? 1 : 0); }
};

void on_signal(int) {
  asked_to_end = true;
  if (DdsBus* bus = stopped_by_signal) bus->stop();
}

int complain(const char* component, const std::exception& error, int code) {
  std::fprintf(stderr, "handsel_%s: %s\n", component, error.what());
  return code;
}

/// Folders to search for names, and settings to use.
struct FileOptions {
  std::vector<std::string> config;   ///< folders and files of --config
  std::vector<std::string> folders;  ///< folders of --path
  Overlays overlays;                 ///< values of --set
};

void add_file_options(CLI::App& app, FileOptions& files) {
  app.add_option("--config", files.config,
                 "folder of the components' settings in place of the shipped one, or a file with "
                 "settings that go over them; may be repeated")
      ->expected(1)
      ->take_all();
  app.add_option("--set", files.overlays.assignments,
                 "a setting, component.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  app.add_option(
         "--path", files.folders,
         "folder in which names are searched first; may be repeated (then HANDSEL_PATH, the "
         "working directory, the project's own)")
      ->expected(1)
      ->take_all();
}

/// Applies the options; returns the folder of the settings, empty for the shipped one.
std::string use_files(FileOptions files) {
  std::string folder;
  search_first(files.folders);
  for (const std::string& path : files.config) {
    if (std::filesystem::is_regular_file(path))
      files.overlays.files.push_back(path);
    else
      folder = path;
  }
  use_overlays(files.overlays);
  return folder;
}

int run(int argc, char** argv, const char* component, const NodeFactory& make_node,
        Urgency urgency) {
  std::string robot, scenario, state;
  FileOptions files;
  std::uint64_t seed = 1;
  bool standby = false, sim_time = false;
  DdsBusSettings settings;
  settings.component = component;
  settings.urgency = urgency;
  settings.domain = static_cast<std::uint32_t>(default_domain());

  CLI::App app{std::string("handsel component ") + component};
  app.add_option("--robot", robot,
                 "robot description: name or file (default: the scenario's, else jido)");
  app.add_option("--scenario", scenario, "scenario: name or file");
  app.add_option("--domain", settings.domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  add_file_options(app, files);
  app.add_option("--state", state,
                 "folder of what must survive a restart (default: HANDSEL_STATE, else a folder of "
                 "the domain)");
  app.add_option("--seed", seed, "of every random choice")->capture_default_str();
  app.add_flag("--sim-time", sim_time,
               "the simulator gives the pace: time stops while a component of the system waits for "
               "a processor")
      ->envname("HANDSEL_SIM_TIME");
  app.add_flag("--realtime", settings.realtime, "SCHED_FIFO and locked memory where permitted");
  app.add_option("--cpu-affinity", settings.cpu, "run the executor on this processor");
  app.add_flag("--standby", standby, "start even when the domain has this component already");
  app.set_version_flag("--version", version_text);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }

  const std::string folder = use_files(std::move(files));
  NodeContext context = load_context(robot, scenario, folder, seed);
  context.sim_time = sim_time;
  settings.sim_time = sim_time && settings.component != "sim";  // the simulator itself grants time
  context.state = state.empty() ? domain_state_directory(static_cast<int>(settings.domain))
                                : std::filesystem::path(state);
  DdsBus bus(settings);
  const EndRequired end_required;  // declared first, so that it covers the end of the bus
  stopped_by_signal = &bus;
  if (!asked_to_end && !standby && bus.has_twin(kTwinWait)) {
    const ConfigError refusal("domain " + std::to_string(settings.domain) + " already has a " +
                              component + "; --standby starts one more");
    require_end(2);
    return complain(component, refusal, 2);
  }
  if (asked_to_end) return 0;
  {
    const std::shared_ptr<void> node = make_node(bus, context);
    bus.set_ready();
    std::printf("handsel_%s ready: domain %u, pid %d%s%s\n", component, settings.domain,
                static_cast<int>(getpid()),
                !settings.realtime            ? ""
                : bus.realtime_note().empty() ? ", real time"
                                              : ", not real time: ",
                settings.realtime ? bus.realtime_note().c_str() : "");
    std::fflush(stdout);
    bus.run();
    require_end(0);
    bus.set_stopping();
    if (!bus.end_jobs(kJobsEnd)) {
      std::fprintf(stderr, "handsel_%s: a job did not stop when asked; ending without it\n",
                   component);
      std::_Exit(0);
    }
  }
  return 0;
}

}  // namespace

int run_process(int argc, char** argv, const char* component, const NodeFactory& make_node,
                Urgency urgency) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
  try {
    return run(argc, argv, component, make_node, urgency);
  } catch (const ConfigError& error) {
    return complain(component, error, 2);
  } catch (const MissingError& error) {
    return complain(component, error, 3);
  } catch (const std::exception& error) {
    return complain(component, error, 1);
  }
}

}  // namespace handsel
