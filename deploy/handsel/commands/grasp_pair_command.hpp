// `handsel grasp choose`, `double`, `transfer` and `regrasp`: grasps that serve, and two hands on one object.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

void add_grasp_choose(CLI::App& grasp, int& exit_code);
void add_grasp_pairs(CLI::App& grasp, int& exit_code);

}  // namespace handsel
