// SPDX-License-Identifier: Apache-2.0
// Compares conditions that were tried with the same seeds: means, paired differences with
// intervals, ratios, and the files of a study.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace handsel {

/// Difference of two conditions over the seeds both have.
struct PairedDifference {
  std::size_t pairs{};       ///< seeds that both conditions have; 0: the rest says nothing
  double first{}, second{};  ///< means
  double difference{};       ///< mean of first - second
  double low{}, high{};      ///< 95 % of it: bootstrap over the pairs, 4000 resamples
  double p{1.0};             ///< two-sided, signs of the differences at random: 10 000 draws
  /// Returns true when the 95 % interval excludes 0.
  bool unlike() const { return pairs > 0 && (low > 0 || high < 0); }
};
/// Equal lengths; seeded, so that equal data give equal numbers. Throws std::invalid_argument
/// otherwise.
PairedDifference paired_difference(const std::vector<double>& first,
                                   const std::vector<double>& second);

/// Two-sided exact test of McNemar: pairs in which only the first, or only the second succeeded.
double mcnemar(int only_first, int only_second);

/// The lines of many trials (of `handsel eval`) by scenario, condition and seed.
class Study {
 public:
  /// Adds a trial; one of the same scenario, condition and seed replaces the earlier one in
  /// comparisons. Throws nlohmann::json::exception without "scenario", "attention" or "seed".
  void add(const nlohmann::json& line);
  /// Returns true before the first trial.
  bool empty() const { return lines_.empty(); }

  /// One line a scenario, condition and measure: `scenario`, `condition`, `against`, `measure`,
  /// `mean`, `mean_against`, `difference`, `low`, `high`, `p`, `pairs`; for `success` with the
  /// Wilson intervals `low_of`, `high_of` of both. All conditions against `reference`.
  std::vector<nlohmann::json> comparison(const std::string& reference) const;
  /// The same for people.
  std::string table(const std::string& reference) const;
  /// One row a trial: order, scenario, condition, participant, seed and the measures.
  std::string csv() const;
  /// Work against separation of one scenario: the fixed rates as a curve, the others as points,
  /// each with its 95 % interval.
  std::string plot(const std::string& scenario) const;
  std::vector<std::string> scenarios() const;   ///< without repetition, in order of the alphabet
  std::vector<std::string> conditions() const;  ///< of all scenarios, in order of the alphabet

 private:
  using Trials = std::map<std::uint64_t, nlohmann::json>;  // by seed
  std::map<std::string, std::map<std::string, Trials>> lines_;
  std::vector<nlohmann::json> rows_;  // in the order they came
};

/// Writes comparison.jsonl, trials.csv, table.txt and a plot a scenario into `folder`, made when it
/// is not there.
void write_study(const Study& study, const std::string& reference,
                 const std::filesystem::path& folder);

}  // namespace handsel
