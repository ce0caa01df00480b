// SPDX-License-Identifier: Apache-2.0
// handsel model new | check | info | fk: robot descriptions and URDFs without a running system.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/model/robot_model.hpp"

namespace handsel {

/// Adds the subcommands; a run writes its exit code to `exit_code`.
void add_model_commands(CLI::App& app, int& exit_code);

/// Adds `new` to the group "model": a robot of a user's URDF.
void add_model_new_command(CLI::App& model, int& exit_code);

/// What a robot lacks to be driven by Handsel, one sentence each; empty when nothing does.
std::vector<std::string> lacks_of(const RobotModel& robot);

}  // namespace handsel
