// SPDX-License-Identifier: Apache-2.0
// handsel distance: contact and distance of pairs of primitive shapes.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

/// Adds the subcommand; it writes the exit code of a run to `exit_code`.
void add_distance_command(CLI::App& app, int& exit_code);

}  // namespace handsel
