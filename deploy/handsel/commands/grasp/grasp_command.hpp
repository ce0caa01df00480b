// SPDX-License-Identifier: Apache-2.0
// `handsel grasp ...`: lists of grasps and the stability of contacts, without DDS.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

/// Adds `grasp` and its subcommands; a run writes its exit code to `exit_code`.
void add_grasp_commands(CLI::App& app, int& exit_code);

}  // namespace handsel
