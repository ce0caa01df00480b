// SPDX-License-Identifier: Apache-2.0
// Scenario files: what one says once a seed has drawn what varies. Own method: each draw has random
// numbers of its own, from the seed and its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "common/config/schema/scenario.pb.h"

namespace handsel {

/// A scenario as one seed draws it.
struct DrawnScenario {
  config::Scenario scenario;  ///< all is drawn: without draws, clutter and top_jitter
  /// Name of the variant by the name of its draw, the number of objects by "clutter".
  std::map<std::string, std::string> variants;
  std::map<std::string, double> tops;  ///< height of the drawn top faces by the id of the box [m]
};

/// Reads a scenario file and draws what varies by the seed: equal files and seeds give equal
/// scenarios in every process. Throws ConfigError or MissingError "file:line:key: ..." also for a
/// variant that this seed does not take.
DrawnScenario draw_scenario(const std::filesystem::path& file, std::uint64_t seed);

/// Returns the scenario that draw_scenario() draws; an empty one when `file` is empty.
config::Scenario read_scenario(const std::filesystem::path& file, std::uint64_t seed);

/// The robot that the scenario (name or file) names or draws, a path as described_path reads it,
/// else "jido"; "jido" also when `scenario` is empty. Throws as draw_scenario().
std::string scenario_robot(const std::string& scenario, std::uint64_t seed);

}  // namespace handsel
