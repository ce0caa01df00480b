// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <nlohmann/json.hpp>

#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/status.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

constexpr Duration kDiscoveryTime = std::chrono::milliseconds(900);

struct StatusOptions {
  int domain{0};
  bool watch{false}, json{false};
};

int show(const StatusOptions& options) {
  catch_interrupts();
  Session session(options.domain);
  session.require_system();
  session.listen(kDiscoveryTime);
  const bool json = json_wanted(options.json);
  SystemStatus status;
  do {
    const TimePoint now = session.bus().now();
    status = make_status(session.snapshot(), now);
    if (options.watch && !json) std::printf("\033[H\033[2J");
    std::printf("%s%s",
                json ? to_json(status, session.snapshot(), now).dump().c_str()
                     : to_text(status, session.snapshot(), now).c_str(),
                json ? "\n" : "");
    std::fflush(stdout);
    if (options.watch) session.listen(from_seconds(0.5));
  } while (options.watch && !interrupted() && !nobody_reads());
  for (const ProcessLine& line : status.processes) {
    if (line.state == "missing" || line.state == "silent" || line.state == "restarting") return 1;
  }
  return 0;
}

}  // namespace

void add_status_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = app.add_subcommand(
      "status",
      "prints the state of each process, the task, the trajectory, and the mode with its causes");
  add_domain_option(*command, options->domain);
  command->add_flag("--watch", options->watch, "print again twice a second until Ctrl-C");
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &exit_code] { exit_code = show(*options); });
}

}  // namespace handsel
