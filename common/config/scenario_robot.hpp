// Which robot a scenario is for.
#pragma once

#include <string>

namespace handsel {

/// The robot that the scenario (name or file) names, a path as described_path reads it, else
/// "jido"; "jido" also when `scenario` is empty. Throws ConfigError / MissingError.
std::string scenario_robot(const std::string& scenario);

}  // namespace handsel
