// SPDX-License-Identifier: Apache-2.0
// `handsel grasp choose`, `double`, `transfer`, `regrasp` and `prepare`: grasps that serve, two
// hands on one object, and lists that are kept.
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

/// Adds `choose` to `grasp`; a run writes its exit code to `exit_code`.
void add_grasp_choose(CLI::App& grasp, int& exit_code);
/// Adds `prepare` to `grasp`, as above.
void add_grasp_prepare(CLI::App& grasp, int& exit_code);
/// Adds `double`, `transfer` and `regrasp` to `grasp`, as above.
void add_grasp_pairs(CLI::App& grasp, int& exit_code);

}  // namespace handsel
