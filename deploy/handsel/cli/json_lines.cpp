// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/cli/json_lines.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <new>

#include "common/base/errors.hpp"
#include "deploy/handsel/cli/json_line.hpp"

namespace handsel::command {

using nlohmann::json;

namespace {

constexpr std::size_t kMaxLine = 16u << 20;  // max line length [bytes]
constexpr int kMaxDepth = 64;  // max depth of lists and objects, as writing is recursive

/// Returns the depth of lists and objects, counted without parsing.
int depth_of(const std::string& text) {
  int depth = 0, deepest = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_text && text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      in_text = !in_text;
    } else if (!in_text && (text[i] == '[' || text[i] == '{')) {
      deepest = std::max(deepest, ++depth);
    } else if (!in_text && (text[i] == ']' || text[i] == '}')) {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

json parse_line(const std::string& line) {
  if (line.size() > kMaxLine)
    throw LineError("a line of " + std::to_string(line.size() >> 20) + " MB; it may have 16 MB");
  if (depth_of(line) > kMaxDepth) throw LineError("lists and objects are nested deeper than 64");
  json item = json::parse(line, nullptr, false);
  if (item.is_discarded()) throw LineError("this is not JSON");
  return item;
}

int for_each_line(std::istream& in, std::ostream& out,
                  const std::function<json(const json&)>& answer,
                  const std::function<std::string(const json&)>& show) {
  bool bad = false;
  long number_of_line = 0, answered = 0;
  std::string line;
  while (std::getline(in, line)) {
    ++number_of_line;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    ++answered;
    const auto refuse = [&](const std::string& why) {
      bad = true;
      out << json{{"line", number_of_line}, {"error", why}}.dump(-1, ' ', false,
                                                                 json::error_handler_t::replace)
          << std::endl;
    };
    try {
      const json result = answer(parse_line(line));
      out << (show ? show(result) : result.dump(-1, ' ', false, json::error_handler_t::replace))
          << std::endl;
    } catch (const LineError& e) {
      refuse(e.what());
    } catch (const ConfigError& e) {
      refuse(e.what());
    } catch (const json::exception& e) {
      refuse("a field has another type than expected (" + std::string(e.what()) + ")");
    } catch (const std::bad_alloc&) {
      refuse("the numbers ask for more memory than there is");
    }
  }
  out.flush();
  if (answered == 0)
    std::cerr << "handsel: nothing came on standard input; one JSON line a case is expected\n";
  return bad || answered == 0 ? 2 : 0;
}

const json& field(const json& object, const char* name) {
  if (!object.is_object())
    throw LineError(std::string("expected an object with the field \"") + name + "\"");
  const auto found = object.find(name);
  if (found == object.end()) throw LineError(std::string("the field \"") + name + "\" is missing");
  return *found;
}

namespace {

double finite(const json& value, const char* name) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    throw LineError(std::string("\"") + name + "\" must be a finite number");
  return value.get<double>();
}

}  // namespace

double number(const json& object, const char* name) { return finite(field(object, name), name); }

double positive(const json& object, const char* name) {
  const double value = number(object, name);
  if (!(value > 0)) throw LineError(std::string("\"") + name + "\" must be greater than 0");
  return value;
}

Vector vector_of(const json& object, const char* name) {
  const json& list = field(object, name);
  if (!list.is_array()) throw LineError(std::string("\"") + name + "\" must be a list of numbers");
  Vector out(static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    out[static_cast<Eigen::Index>(i)] = finite(list[i], name);
  return out;
}

Vector3 vector3(const json& object, const char* name) {
  const Vector v = vector_of(object, name);
  if (v.size() != 3)
    throw LineError(std::string("\"") + name + "\" must have 3 numbers, it has " +
                    std::to_string(v.size()));
  return v;
}

Eigen::Quaterniond quaternion(const json& object, const char* name) {
  const Vector v = vector_of(object, name);
  if (v.size() != 4)
    throw LineError(std::string("\"") + name + "\" must have 4 numbers (x y z w), it has " +
                    std::to_string(v.size()));
  if (!(v.norm() > 1e-9)) throw LineError(std::string("\"") + name + "\" must not be zero");
  return Eigen::Quaterniond(v[3], v[0], v[1], v[2]).normalized();
}

}  // namespace handsel::command
