// SPDX-License-Identifier: Apache-2.0
// Options that `up`, `run` and others share.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "deploy/handsel/system/system.hpp"

namespace handsel {

inline constexpr Duration kReadyTimeout = std::chrono::seconds(15);

/// --domain N (default: $HANDSEL_DOMAIN, else 0), --name NAME (through $HANDSEL_NAME).
void add_domain_option(CLI::App& command, int& domain);
/// --robot, --scenario, --seed, --domain, --port, --record, --ros2, --help-hold, --config, --set.
void add_system_options(CLI::App& command, SystemOptions& options);
/// --config FILE and --set component.key=value, both repeatable: overlays of this process and of
/// those that it starts.
void add_overlay_options(CLI::App& command);
/// --help-hold, passed to the simulator through the environment's HANDSEL_HELP_HOLD.
void add_help_hold_option(CLI::App& command);
/// Prints the page's address, or why there is no page; opens it in a browser when there is a
/// display and not `headless`.
void announce_page(System& system, bool headless);

}  // namespace handsel
