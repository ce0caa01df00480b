// SPDX-License-Identifier: Apache-2.0
// handsel plan: collision-free paths for problems given as JSON Lines.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

/// Adds the subcommand; it writes the exit code of a run to `exit_code`: 1 when some problem was
/// not solved.
void add_plan_command(CLI::App& app, int& exit_code);

}  // namespace handsel
