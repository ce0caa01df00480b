// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/environment/environment.hpp"

namespace handsel {
namespace {

struct EnvironmentOptions {
  std::string scenario, robot;
};

}  // namespace

void add_environment_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EnvironmentOptions>();
  CLI::App* command = app.add_subcommand(
      "environment",
      "runs a scenario in lock-step step by step: one request of JSON a line on the standard "
      "input, one answer a line; handsel.Environment in Python sends them");
  command->add_option("scenario,--scenario", options->scenario, "scenario: name or file")
      ->required();
  command->add_option("--robot", options->robot, "robot description (default: the scenario's)");
  command->callback([options, &exit_code] {
    environment::Environment system(options->scenario, options->robot);
    exit_code = command::for_each_line(
        std::cin, std::cout, [&](const nlohmann::json& request) { return system.answer(request); });
  });
}

}  // namespace handsel
