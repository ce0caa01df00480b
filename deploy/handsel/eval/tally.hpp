// SPDX-License-Identifier: Apache-2.0
// The table at the end of `handsel eval`: successes with intervals and reasons of failures, of all
// trials and by what the seeds drew.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace handsel {

/// What a group of trials came to.
struct Tally {
  int trials{0}, successes{0};          ///< number of trials and of those that succeeded
  int drops{0};                         ///< trials in which the object was dropped
  int separations{0};                   ///< trials with a violation of the separation
  std::map<std::string, int> failures;  ///< number by "kind: reason"
  /// Adds the line of a trial. Throws nlohmann::json::exception without "success".
  void add(const nlohmann::json& line);
};

/// The lines of many trials by scenario, and by what was drawn in each.
class TrialTable {
 public:
  /// Adds the line of a trial. Throws nlohmann::json::exception without "scenario" or "success".
  void add(const nlohmann::json& line);
  /// Returns a table of the scenarios with 95 % score intervals and reasons; for each scenario with
  /// draws followed by one table for each heading in `by`, for all headings when `by` is empty.
  std::string text(const std::vector<std::string>& by) const;
  /// Returns the headings of all scenarios by which trials can be grouped.
  std::vector<std::string> headings() const;

 private:
  struct Scenario {
    Tally all;
    std::map<std::string, std::map<std::string, Tally>> groups;  // by heading and value
  };
  std::map<std::string, Scenario> scenarios_;
};

}  // namespace handsel
