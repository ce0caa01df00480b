// SPDX-License-Identifier: Apache-2.0
// Reads the files that SPARK needs at its start.
#pragma once

#include <filesystem>

#include "common/config/settings/spark.hpp"

namespace handsel::spark {

/// Returns the settings of spark.txtpb in `folder`, with the profiles of the people. Throws
/// ConfigError if a value is out of range.
settings::SparkSettings load_settings(const std::filesystem::path& folder);

}  // namespace handsel::spark
