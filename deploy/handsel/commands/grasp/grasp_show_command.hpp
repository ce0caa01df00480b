// SPDX-License-Identifier: Apache-2.0
// `handsel grasp show`: pictures of grasps.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

/// Adds `show` to `grasp`; a run writes its exit code to `exit_code`.
void add_grasp_show(CLI::App& grasp, int& exit_code);

}  // namespace handsel
