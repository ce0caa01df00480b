// SPDX-License-Identifier: Apache-2.0
// JSON Lines in, JSON Lines out, as every batch tool of the command does it (docs: a bad line is
// answered, the rest still runs).
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

#include "common/geometry/pose.hpp"

namespace handsel::command {

/// What is wrong with one input line, in one sentence.
struct LineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Calls `answer` for every line that is not blank and writes what it returns. A line that is no
/// JSON, or for which `answer` throws LineError or ConfigError, yields {"line": n, "error": "..."}
/// (n from 1). Returns 2 if there was such a line or no line at all, else 0. `show` writes an
/// answer for people instead; refusals stay JSON.
int for_each_line(std::istream& in, std::ostream& out,
                  const std::function<nlohmann::json(const nlohmann::json&)>& answer,
                  const std::function<std::string(const nlohmann::json&)>& show = {});

/// Returns a field by name; throws LineError naming the field when `object` lacks it.
const nlohmann::json& field(const nlohmann::json& object, const char* name);
/// Returns a finite number; throws LineError for anything else.
double number(const nlohmann::json& object, const char* name);
/// Returns a finite number above 0; throws LineError for anything else.
double positive(const nlohmann::json& object, const char* name);
/// Returns a list of finite numbers, which may be empty; throws LineError for anything else.
Vector vector_of(const nlohmann::json& object, const char* name);
/// Returns a list of three finite numbers; throws LineError for anything else.
Vector3 vector3(const nlohmann::json& object, const char* name);
/// Returns the unit quaternion of a list x, y, z, w of any norm above 1e-9; throws LineError for
/// anything else.
Eigen::Quaterniond quaternion(const nlohmann::json& object, const char* name);

}  // namespace handsel::command
