// SPDX-License-Identifier: Apache-2.0
// Reads attention.txtpb.
#pragma once

#include <filesystem>

#include "components/attention/attention.hpp"

namespace handsel::attention {

/// Returns the settings of a file. Throws ConfigError or MissingError that names file, line and
/// key.
AttentionSettings load_settings(const std::filesystem::path& file);

}  // namespace handsel::attention
