// `handsel grasp show`: pictures of grasps.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

void add_grasp_show(CLI::App& grasp, int& exit_code);

}  // namespace handsel
