// The files that SPARK reads when it starts.
#pragma once

#include <filesystem>

#include "common/config/schema/scenario.pb.h"
#include "common/config/settings/spark.hpp"

namespace handsel::spark {

/// Returns the settings of spark.txtpb in `folder`, with the profiles of the people. Throws
/// ConfigError when a value is out of range.
settings::SparkSettings load_settings(const std::filesystem::path& folder);
/// Returns the scenario of a file; an empty one when `file` is empty.
config::Scenario load_scenario(const std::filesystem::path& file);

}  // namespace handsel::spark
