// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/fakes/fake_script.hpp"

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/errors.hpp"

namespace handsel::drivers {

namespace {

const std::map<std::string, bool FakeEvents::*> kSwitches{
    {"emergency_stop", &FakeEvents::emergency_stop},
    {"user_stop", &FakeEvents::user_stop},
    {"brake", &FakeEvents::brake},
    {"power", &FakeEvents::power_off}};

const std::map<std::string, FakeTrigger> kMoments{{"after", FakeTrigger::after},
                                                  {"moving", FakeTrigger::moving},
                                                  {"standing", FakeTrigger::standing}};

bool number(const std::string& text, double& out) {
  char* end = nullptr;
  out = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' && std::isfinite(out);
}

/// Reads a line of the script; returns the reason of an error, or an empty text.
std::string read(const std::string& text, FakeLine& line) {
  std::istringstream in(text);
  std::string when, amount;
  in >> when >> amount >> line.verb;
  const auto moment = kMoments.find(when);
  if (moment == kMoments.end())
    return "\"" + when + "\" is no moment; a line begins with after, moving or standing";
  line.trigger = moment->second;
  if (!number(amount, line.amount) || line.amount < 0.0)
    return "\"" + when + "\" wants a number that is not below 0, not \"" + amount + "\"";
  std::getline(in >> std::ws, line.value);
  line.value.resize(line.value.find_last_not_of(" \t\r") + 1);
  double value = 0.0;
  if (kSwitches.contains(line.verb)) {
    if (line.value != "on" && line.value != "off")
      return line.verb + " is on or off, not \"" + line.value + "\"";
  } else if (line.verb == "drop" || line.verb == "delay" || line.verb == "push" ||
             line.verb == "object") {
    if (!number(line.value, value))
      return line.verb + " wants a number, not \"" + line.value + "\"";
  } else if (line.verb != "say") {
    return "\"" + line.verb +
           "\" does not happen; known are emergency_stop, user_stop, brake, power, drop, delay, "
           "push, object and say";
  }
  return {};
}

}  // namespace

std::vector<FakeLine> load_fake_script(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw MissingError(file.string() + ": no such script");
  std::vector<FakeLine> lines;
  int row = 0;
  for (std::string text; std::getline(in, text);) {
    ++row;
    text.resize(std::min(text.size(), text.find('#')));
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    FakeLine line;
    if (const std::string why = read(text, line); !why.empty())
      throw ConfigError(file.string() + ":" + std::to_string(row) + ": " + why);
    lines.push_back(line);
  }
  return lines;
}

std::string FakeScript::step(FakeArm& arm, double dt) {
  waited_ += dt;
  stood_ = arm.speed() > 0.0 ? 0.0 : stood_ + dt;
  if (next_ >= lines_.size()) return {};
  const FakeLine& line = lines_[next_];
  const bool now = line.trigger == FakeTrigger::after    ? waited_ >= line.amount
                   : line.trigger == FakeTrigger::moving ? arm.speed() > line.amount
                                                         : std::min(stood_, waited_) >= line.amount;
  if (!now) return {};
  ++next_;
  waited_ = 0.0;
  double value = 0.0;
  number(line.value, value);
  if (const auto it = kSwitches.find(line.verb); it != kSwitches.end())
    arm.events.*(it->second) = (line.value == "on") != (line.verb == "power");
  else if (line.verb == "drop")
    arm.events.drop = static_cast<int>(value);
  else if (line.verb == "delay")
    delay_ = 1e-3 * value;
  else if (line.verb == "push")
    arm.events.push = value;
  else if (line.verb == "object")
    arm.events.object = value;
  else
    return line.value;
  return line.verb + " " + line.value;
}

}  // namespace handsel::drivers
