// SPDX-License-Identifier: Apache-2.0
// Reads trajectory_controller.txtpb.
#pragma once

#include <filesystem>

#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

/// Throws ConfigError / MissingError naming file, line and key.
ControllerSettings load_settings(const std::filesystem::path& file);

}  // namespace handsel::trajectory_controller
