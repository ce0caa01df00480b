// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "common/base/errors.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/offline/scene_check.hpp"
#include "deploy/handsel/offline/settings_list.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {

void add_up_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SystemOptions>();
  auto headless = std::make_shared<bool>(false);
  CLI::App* up = app.add_subcommand(
      "up", "starts all processes, restarts those that end, stops all on Ctrl-C");
  add_system_options(*up, *options);
  up->add_option("--only", options->only,
                 "start only these processes, e.g. spark,bridge; the others run elsewhere")
      ->delimiter(',');
  up->add_option("--without", options->without,
                 "start all processes but these, e.g. sim if a robot's driver runs")
      ->delimiter(',');
  up->add_flag("--headless", *headless, "open no browser");
  up->callback([options, headless, &exit_code] {
    catch_interrupts();
    report_changed_settings();
    check_scene(*options);
    System system(*options);
    std::fprintf(stderr, "starting %zu processes on DDS domain %d, scenario %s; logs in %s\n",
                 system.launcher().processes().size(), options->domain, options->scenario.c_str(),
                 system.log_directory().c_str());
    // A part of a system waits, as it cannot check components started elsewhere.
    const auto took = system.wait_ready(options->whole() ? kReadyTimeout
                                                         : Duration(std::chrono::hours(24 * 365)));
    if (took) {
      std::fprintf(stderr, "ready after %.1f s\n", to_seconds(*took));
      announce_page(system, *headless);
      while (!interrupted()) system.wait(from_seconds(3600), [] { return false; });
    }
    std::fprintf(stderr, "stopping\n");
    exit_code = 0;
  });
}

}  // namespace handsel
