// SPDX-License-Identifier: Apache-2.0
// Estimates a person's stature from the distances between joints. Pure.
#pragma once

#include "common/messages/perception.hpp"

namespace handsel::spark {

/// Averages, over about 60 samples, the median of the statures that follow from each observed bone
/// and the proportions of standing_body. Own method: independent of the configuration, as people
/// bend and sit.
class BodySize {
 public:
  /// Takes a sample of all bones with two joints of a confidence of at least 0.3; ignores a stature
  /// outside [0.6, 2.2] m.
  void add_sample(const ObservedPerson& body);
  /// Returns the stature [m]; 1.75 before the first sample; changes in steps above 0.02.
  double stature() const { return stature_; }

 private:
  double mean_{}, stature_{1.75};
  int samples_{0};
};

}  // namespace handsel::spark
