// SPDX-License-Identifier: Apache-2.0
// How the launcher detects hung processes and starts processes again: deploy/config/launcher.txtpb.
#pragma once

#include <filesystem>

#include "deploy/handsel/system/liveness.hpp"

namespace handsel {

struct LauncherSettings {
  LivenessSettings liveness;  ///< when a process counts as hung
  BackoffSettings backoff;    ///< between a death and the next start
};

/// Throws ConfigError "file:line:key: ..." for a value that is not a number or out of range. What
/// the file leaves out has its default value.
LauncherSettings load_launcher_settings(const std::filesystem::path& file);

}  // namespace handsel
