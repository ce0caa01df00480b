// Reads attention.txtpb.
#pragma once

#include <filesystem>

#include "components/attention/attention.hpp"

namespace handsel::attention {

/// Throws ConfigError / MissingError naming file, line and key.
AttentionSettings load_settings(const std::filesystem::path& file);

}  // namespace handsel::attention
