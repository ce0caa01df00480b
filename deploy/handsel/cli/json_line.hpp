// SPDX-License-Identifier: Apache-2.0
// One line of JSON from anybody.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace handsel::command {

/// Parses one line. Throws LineError when the line is no JSON, longer than 16 MB or nested deeper
/// than 64.
nlohmann::json parse_line(const std::string& line);

}  // namespace handsel::command
