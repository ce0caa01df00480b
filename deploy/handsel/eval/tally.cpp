// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/tally.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <set>

#include "deploy/handsel/eval/trial.hpp"

namespace handsel {
namespace {

std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string formatted(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

std::string heading(const std::string& of) {
  return formatted("%-24s %7s %8s   %-22s %6s %11s\n", of.c_str(), "trials", "success",
                   "95 % interval (Wilson)", "drops", "separation");
}

std::string row(const std::string& name, const Tally& tally) {
  const auto [low, high] = wilson_interval(tally.successes, tally.trials);
  std::string text = formatted("%-24s %7d %6.1f %%   %5.1f … %5.1f %%          %6d %11d\n",
                               name.c_str(), tally.trials, 100.0 * tally.successes / tally.trials,
                               100 * low, 100 * high, tally.drops, tally.separations);
  for (const auto& [failure, count] : tally.failures)
    text += formatted("  %4d ", count) + failure + "\n";
  return text;
}

/// Returns the values of one heading of a trial: one text, several, or none for a number.
std::vector<std::string> values_of(const nlohmann::json& drawn) {
  std::vector<std::string> values;
  if (drawn.is_string()) values.push_back(drawn.get<std::string>());
  if (drawn.is_array())
    for (const auto& value : drawn)
      if (value.is_string()) values.push_back(value.get<std::string>());
  return values;
}

}  // namespace

void Tally::add(const nlohmann::json& line) {
  const bool success = line.at("success");
  ++trials;
  successes += success;
  drops += line.value("drops", 0) > 0;
  separations += line.value("ssm_violations", 0) > 0;
  if (!success) ++failures[line.value("failure", "") + ": " + line.value("reason", "")];
}

void TrialTable::add(const nlohmann::json& line) {
  Scenario& scenario = scenarios_[line.at("scenario")];
  scenario.all.add(line);
  const auto drawn = line.find("drawn");
  if (drawn == line.end() || !drawn->is_object()) return;
  for (const auto& [name, value] : drawn->items())
    for (const std::string& each : values_of(value)) scenario.groups[name][each].add(line);
}

std::string TrialTable::text(const std::vector<std::string>& by) const {
  std::string text = heading("scenario");
  for (const auto& [name, scenario] : scenarios_) text += row(name, scenario.all);
  for (const auto& [name, scenario] : scenarios_) {
    for (const auto& [what, groups] : scenario.groups) {
      if (!by.empty() && std::find(by.begin(), by.end(), what) == by.end()) continue;
      text += "\n" + heading(name + " by " + what);
      for (const auto& [value, tally] : groups) text += row(value, tally);
    }
  }
  return text;
}

std::vector<std::string> TrialTable::headings() const {
  std::set<std::string> all;
  for (const auto& [name, scenario] : scenarios_)
    for (const auto& [what, groups] : scenario.groups) all.insert(what);
  return {all.begin(), all.end()};
}

}  // namespace handsel
