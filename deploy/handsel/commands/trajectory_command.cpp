// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/offline/trajectory_lines.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace command;

CLI::App* batch(CLI::App* group, const char* name, const char* what, int& exit_code,
                const std::function<json(const json&)>& answer) {
  CLI::App* command = group->add_subcommand(name, what);
  command->add_flag("--json")->description("has no effect: the output is always JSON Lines");
  command->callback(
      [&exit_code, answer] { exit_code = for_each_line(std::cin, std::cout, answer); });
  return command;
}

}  // namespace

void add_trajectory_commands(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand(
      "trajectory",
      "computes jerk-limited motion; reads JSON Lines from stdin and prints one answer for each");
  group->require_subcommand(1);
  batch(group, "solve", "computes motions from state to state in minimum or imposed time",
        exit_code, solve_line)
      ->footer(
          "Input line: {\"p0\",\"v0\",\"a0\",\"pf\",\"vf\",\"af\",\"vmax\",\"amax\",\"jmax\": "
          "lists "
          "over axes, "
          "\"sync\"?: \"time\"|\"none\", \"impose\"?: true, \"duration\"?}; ? marks fields that "
          "may be missing");
  batch(group, "smooth", "computes smooth motions through the nodes of polylines", exit_code,
        smooth_line)
      ->footer("Input line: {\"nodes\":[[...],...],\"vmax\",\"amax\",\"jmax\",\"tau\"?}");
  auto period = std::make_shared<double>(0.01);
  batch(group, "sample",
        "prints states of trajectories (as printed by solve and smooth) at regular times",
        exit_code, [period](const json& line) { return sample_line(line, *period); })
      ->add_option("--period", *period, "time between two states [s]")
      ->check(kAboveZero)
      ->capture_default_str();
  add_cartesian_command(*group, exit_code);
  add_timed_command(*group, exit_code);
}

}  // namespace handsel
