// SPDX-License-Identifier: Apache-2.0
// Where the hands of people are on the objects that they hold, averaged.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "common/messages/world.hpp"
#include "common/model/human/holding_hand.hpp"
#include "common/model/object_model.hpp"

namespace handsel {

/// Averages wrists and hands relative to the objects that they hold: single positions are noisy,
/// and an object does not move in the hand of its holder. Own method.
class HoldingHandAverage {
 public:
  /// Returns the model of that name; null: unknown. Empty: nothing is averaged.
  using Models = std::function<const ObjectModel*(const std::string&)>;

  /// `samples`: each sample counts 1 / samples, the first samples as their mean; >= 1.
  HoldingHandAverage(Models models, int samples);

  /// Adds where hands and objects are, both in the world frame.
  void add(const Scene& scene, const HumanState& people);
  /// Returns these people; hands that hold objects of the scene, and their wrists, are where they
  /// are on average. Hands of which no sample was added are unchanged.
  HumanState averaged(const Scene& scene, HumanState people) const;

 private:
  struct Hold {
    std::string person;  // id
    HoldingHand hand;    // on average
    HoldingHand recent;  // on average over the last few samples
    int samples{}, palm_samples{};

    void add(const HoldingHand& seen, int max_samples);
  };

  Models models_;
  int max_samples_;
  std::map<std::string, Hold> holds_;  // by object
};

}  // namespace handsel
