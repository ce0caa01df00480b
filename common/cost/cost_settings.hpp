// SPDX-License-Identifier: Apache-2.0
// The settings of the human-aware cost from their file.
#pragma once

#include <filesystem>

#include "common/cost/human_cost.hpp"

namespace handsel {

/// Reads cost.txtpb of a settings directory. Throws ConfigError / MissingError naming file and
/// field.
CostSettings load_cost_settings(const std::filesystem::path& directory);

}  // namespace handsel
