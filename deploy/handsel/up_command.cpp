#include <cstdio>
#include <cstdlib>

#include "common/base/errors.hpp"
#include "deploy/handsel/commands.hpp"
#include "deploy/handsel/system.hpp"
#include "deploy/handsel/system_options.hpp"

namespace handsel {

void add_up_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SystemOptions>();
  auto headless = std::make_shared<bool>(false);
  CLI::App* up = app.add_subcommand("up", "starts every process, restarts what dies, stops all on Ctrl-C");
  add_system_options(*up, *options);
  up->add_flag("--headless", *headless, "open no browser");
  up->callback([options, headless, &exit_code] {
    catch_interrupts();
    System system(*options);
    std::fprintf(stderr, "starting %zu processes on DDS domain %d, scenario %s; logs in %s\n", kProcesses.size(), options->domain,
                 options->scenario.c_str(), system.log_directory().c_str());
    const auto took = system.wait_ready(kReadyPatience);
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
