// How tall somebody is, from the distances between their joints. Pure.
#pragma once

#include "common/messages/perception.hpp"

namespace handsel::spark {

/// Each bone seen gives a stature by the proportions of standing_body; the median of a look counts, averaged over the last looks. Posture
/// does not matter. Ours.
class BodySize {
 public:
  void see(const ObservedPerson& body);
  double stature() const { return told_; }  ///< [m]; 1.75 until a bone was seen; small corrections are not told

 private:
  double mean_{}, told_{1.75};
  int looks_{0};
};

}  // namespace handsel::spark
