// SPDX-License-Identifier: Apache-2.0
// Estimates a person's stature from the distances between joints. Pure.
#pragma once

#include <optional>

#include "common/config/settings/spark.hpp"
#include "common/messages/perception.hpp"

namespace handsel::spark {

/// Averages, over `stature_samples`, the median of the statures that follow from each observed bone
/// and the proportions of standing_body. Own method: independent of the configuration, as people
/// bend and sit.
class BodySize {
 public:
  /// Takes a sample of all bones with two joints of a confidence of at least
  /// `stature_min_confidence`; ignores a stature outside `min_stature` and `max_stature`.
  void add_sample(const ObservedPerson& body, const settings::SparkSettings& settings);
  /// Returns the stature [m]; `assumed_stature` before the first sample; changes in steps above
  /// `stature_step`.
  double stature(const settings::SparkSettings& settings) const {
    return stature_.value_or(settings.assumed_stature);
  }

 private:
  double mean_{};
  std::optional<double> stature_;
  int samples_{0};
};

}  // namespace handsel::spark
