// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/axis_limits.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/config/text_check.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace {

/// One line "key: value" of a YAML file, without comment.
struct YamlLine {
  std::size_t indent{};
  std::string key, value;
  int number{};
};

std::vector<YamlLine> yaml_lines(const std::filesystem::path& file) {
  std::vector<YamlLine> lines;
  std::istringstream in(read_text_file(file));
  int number = 0;
  for (std::string text; std::getline(in, text);) {
    ++number;
    text.erase(std::find(text.begin(), text.end(), '#'), text.end());
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0)
      text.pop_back();
    const auto indent = text.find_first_not_of(' ');
    const auto colon = text.find(':');
    if (indent == std::string::npos || text.starts_with("---")) continue;
    if (colon == std::string::npos || colon < indent)
      throw ConfigError(file.string() + ":" + std::to_string(number) + ": \"" +
                        printable(text, 60) + "\" is no line \"key: value\" of joint_limits.yaml");
    YamlLine line{indent, text.substr(indent, colon - indent), text.substr(colon + 1), number};
    line.value.erase(0, std::min(line.value.find_first_not_of(' '), line.value.size()));
    std::erase_if(line.key, [](char c) { return c == '"' || c == '\''; });
    lines.push_back(line);
  }
  return lines;
}

double positive(const YamlLine& line, const std::filesystem::path& file) {
  char* end = nullptr;
  const double value = std::strtod(line.value.c_str(), &end);
  if (end == line.value.c_str() || *end != '\0' || !std::isfinite(value) || value < 0)
    throw ConfigError(file.string() + ":" + std::to_string(line.number) + ": " + line.key +
                      " is \"" + printable(line.value, 40) + "\", must be a number of at least 0");
  return value;
}

std::string digits_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Rounds down to three digits, so that the text is no larger than the limit.
double rounded_down(double value) {
  if (!(value > 0)) return value;
  const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
  return std::floor(value / unit * (1 + 1e-12)) * unit;
}

}  // namespace

std::map<std::string, YamlLimits> read_joint_limits(const std::filesystem::path& yaml) {
  std::map<std::string, YamlLimits> limits;
  bool inside = false, found = false;
  std::size_t section = 0, joint_indent = 0;
  std::string joint;
  std::map<std::string, bool> unused;  // limits that the file switches off, by joint and kind
  for (const YamlLine& line : yaml_lines(yaml)) {
    if (line.key == "joint_limits") {
      inside = found = true;
      section = line.indent;
      joint.clear();
      continue;
    }
    if (inside && line.indent <= section) inside = false;
    if (!inside) continue;
    if (joint.empty() || line.indent <= joint_indent) {
      joint = line.key;
      joint_indent = line.indent;
      limits[joint];
      continue;
    }
    YamlLimits& to = limits[joint];
    if (line.key == "max_velocity") to.velocity = positive(line, yaml);
    if (line.key == "max_acceleration") to.acceleration = positive(line, yaml);
    if (line.key == "max_jerk") to.jerk = positive(line, yaml);
    if (line.key.starts_with("has_") && line.value == "false") unused[joint + line.key] = true;
  }
  if (!found) throw ConfigError(yaml.string() + ": has no \"joint_limits:\", as MoveIt writes it");
  for (auto& [name, to] : limits) {
    if (unused.contains(name + "has_velocity_limits")) to.velocity = 0;
    if (unused.contains(name + "has_acceleration_limits")) to.acceleration = 0;
    if (unused.contains(name + "has_jerk_limits")) to.jerk = 0;
  }
  return limits;
}

std::vector<AxisLimitSet> find_limits(const RobotModel& robot, const Group& arm,
                                      const std::map<std::string, YamlLimits>& given,
                                      const LimitAssumptions& assumed) {
  std::vector<AxisLimitSet> out;
  for (int i = 0; i < robot.dof(); ++i) {
    const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
    const Joint& joint = robot.joints()[static_cast<std::size_t>(axis.joint)];
    const bool slides = joint.kind == JointKind::prismatic;
    const auto yaml = given.find(axis.name);
    const YamlLimits file = yaml == given.end() ? YamlLimits{} : yaml->second;
    AxisLimitSet set;
    set.joint = axis.name;
    set.velocity = file.velocity > 0 ? file.velocity : joint.max_velocity;
    set.source = std::string("velocity: ") + (file.velocity > 0 ? "joint_limits.yaml" : "URDF");
    if (!slides && set.velocity > assumed.max_speed)
      throw ConfigError("joint " + axis.name + " has a velocity of " + digits_of(set.velocity) +
                        " rad/s, which looks like degrees per second: multiply by pi/180");
    if (file.acceleration > 0) {
      set.acceleration = file.acceleration;
      set.source += "; acceleration: joint_limits.yaml";
    } else {
      set.acceleration = slides ? assumed.sliding_ratio * set.velocity
                                : std::clamp(assumed.acceleration_ratio * set.velocity,
                                             assumed.min_acceleration, assumed.max_acceleration);
      set.source += "; acceleration: assumed";
    }
    set.jerk = file.jerk > 0 ? file.jerk : assumed.jerk_ratio * set.acceleration;
    set.source += file.jerk > 0 ? "; jerk: joint_limits.yaml" : "; jerk: assumed";
    set.assumed = !(file.acceleration > 0 && file.jerk > 0);
    const auto place = std::find(arm.axes.begin(), arm.axes.end(), i) - arm.axes.begin();
    const double comfort = slides      ? assumed.comfort_sliding_speed
                           : place < 4 ? assumed.comfort_speed
                                       : assumed.comfort_wrist_speed;
    const double margin = 1 / assumed.guard_margin;
    constexpr double kAcceleration = 2, kJerk = 6;  // planning ratios of the chapter [1/s], [1/s^2]
    set.comfort_velocity = rounded_down(std::min(comfort, margin * set.velocity));
    set.comfort_acceleration = rounded_down(
        std::min((slides ? 3 : 1) * kAcceleration * comfort, margin * set.acceleration));
    set.comfort_jerk =
        rounded_down(std::min((slides ? 10 : 1) * kJerk * comfort, margin * set.jerk));
    out.push_back(set);
  }
  return out;
}

}  // namespace handsel
