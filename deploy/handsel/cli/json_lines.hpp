// JSON Lines in, JSON Lines out, as every batch tool of the command does it (docs: a bad line is answered, the rest still runs).
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

/// Calls `answer` for every line that is not blank and writes what it returns. A line that is no JSON, or for which `answer` throws
/// LineError or ConfigError, yields {"line": n, "error": "..."} (n from 1). Returns 2 if there was such a line or no line at all, else 0.
/// `show` writes an answer for people instead; refusals stay JSON.
int for_each_line(std::istream& in, std::ostream& out, const std::function<nlohmann::json(const nlohmann::json&)>& answer,
                  const std::function<std::string(const nlohmann::json&)>& show = {});

/// Fields by name; LineError names the field when it is missing, of the wrong type or not finite.
const nlohmann::json& field(const nlohmann::json& object, const char* name);
double number(const nlohmann::json& object, const char* name);
double positive(const nlohmann::json& object, const char* name);
Vector vector_of(const nlohmann::json& object, const char* name);
Vector3 vector3(const nlohmann::json& object, const char* name);
/// x y z w, of any length but 0.
Eigen::Quaterniond quaternion(const nlohmann::json& object, const char* name);

}  // namespace handsel::command
