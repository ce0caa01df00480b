// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "common/base/errors.hpp"
#include "common/bus/dds/dds_bus.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

struct HealthOptions {
  int domain{0};
  double within{2.0};
  std::string component;
};

/// Subscribes to health only, as this runs repeatedly beside every process of a deployment.
int ask(const HealthOptions& options) {
  catch_interrupts();
  DdsBus bus({.component = "handsel",
              .domain = static_cast<std::uint32_t>(options.domain),
              .health = false});
  Snapshot received;
  bus.subscribe<ComponentHealth>([&](const ComponentHealth& health, const Receipt& receipt) {
    received.health[health.component] = {
        .ever = true, .sample = health, .arrival = receipt.arrival};
  });
  bus.every(from_seconds(0.02), [](TimePoint) {});
  const auto lacking = [&] {
    if (options.component.empty()) return not_ready(received);
    const std::string why = why_not_ready(received, options.component);
    return why.empty() ? std::vector<std::string>{}
                       : std::vector<std::string>{options.component + " (" + why + ")"};
  };
  const bool ready = bus.run_until([&] { return interrupted() || lacking().empty(); },
                                   from_seconds(options.within));
  if (ready && !interrupted()) {
    std::printf("%s\n", options.component.empty() ? "every process is ok"
                                                  : (options.component + " is ok").c_str());
    return 0;
  }
  std::string text;
  for (const std::string& one : lacking()) text += (text.empty() ? "" : ", ") + one;
  std::printf("not ready on DDS domain %d: %s\n", options.domain, text.c_str());
  return received.health.empty() ? 3 : 1;
}

}  // namespace

void add_health_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<HealthOptions>();
  CLI::App* command =
      app.add_subcommand("health",
                         "tests whether a process, or without a name the whole system, works; exit "
                         "code 0: it works, 1: it does not, 3: nothing is received");
  add_domain_option(*command, options->domain);
  command->add_option("--within", options->within, "max time to wait until it works [s]")
      ->capture_default_str()
      ->check(kAboveZero);
  command->add_option("component", options->component,
                      "name of the process as printed by `handsel status`: spark, supervisor, ...");
  command->callback([options, &exit_code] { exit_code = ask(*options); });
}

}  // namespace handsel
