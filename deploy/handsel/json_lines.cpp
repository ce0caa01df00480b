#include "deploy/handsel/json_lines.hpp"

#include <cmath>
#include <iostream>

#include "common/base/errors.hpp"

namespace handsel::command {

using nlohmann::json;

int for_each_line(std::istream& in, std::ostream& out, const std::function<json(const json&)>& answer,
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
      out << json{{"line", number_of_line}, {"error", why}}.dump(-1, ' ', false, json::error_handler_t::replace) << '\n';
    };
    const json item = json::parse(line, nullptr, false);
    if (item.is_discarded()) {
      refuse("this is not JSON");
      continue;
    }
    try {
      const json result = answer(item);
      out << (show ? show(result) : result.dump(-1, ' ', false, json::error_handler_t::replace)) << std::endl;
    } catch (const LineError& e) {
      refuse(e.what());
    } catch (const ConfigError& e) {
      refuse(e.what());
    }
  }
  out.flush();
  if (answered == 0) std::cerr << "handsel: nothing came on standard input; one JSON line a case is expected\n";
  return bad || answered == 0 ? 2 : 0;
}

const json& field(const json& object, const char* name) {
  if (!object.is_object()) throw LineError(std::string("expected an object with the field \"") + name + "\"");
  const auto found = object.find(name);
  if (found == object.end()) throw LineError(std::string("the field \"") + name + "\" is missing");
  return *found;
}

namespace {

double finite(const json& value, const char* name) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) throw LineError(std::string("\"") + name + "\" must be a finite number");
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
  for (std::size_t i = 0; i < list.size(); ++i) out[static_cast<Eigen::Index>(i)] = finite(list[i], name);
  return out;
}

Vector3 vector3(const json& object, const char* name) {
  const Vector v = vector_of(object, name);
  if (v.size() != 3) throw LineError(std::string("\"") + name + "\" must have 3 numbers, it has " + std::to_string(v.size()));
  return v;
}

Eigen::Quaterniond quaternion(const json& object, const char* name) {
  const Vector v = vector_of(object, name);
  if (v.size() != 4) throw LineError(std::string("\"") + name + "\" must have 4 numbers (x y z w), it has " + std::to_string(v.size()));
  if (!(v.norm() > 1e-9)) throw LineError(std::string("\"") + name + "\" must not be zero");
  return Eigen::Quaterniond(v[3], v[0], v[1], v[2]).normalized();
}

}  // namespace handsel::command
