// `handsel grasp double`, `transfer` and `regrasp`: two hands on one object.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

void add_grasp_pairs(CLI::App& grasp, int& exit_code);

}  // namespace handsel
