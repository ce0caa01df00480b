// How tall somebody is, from the distances between their joints. Pure.
#pragma once

#include "common/messages/perception.hpp"

namespace handsel::spark {

/// Each bone seen gives a stature by the proportions of standing_body; the median of a sample
/// counts, averaged over about 60. The configuration does not matter. Own method: people bend
/// and sit.
class BodySize {
 public:
  /// Takes in the bones whose two joints have a confidence of 0.3 or more; a stature outside [0.6,
  /// 2.2] m is left out.
  void see(const ObservedPerson& body);
  /// [m]; 1.75 until a bone was seen; follows the average in steps above 0.02.
  double stature() const { return stature_; }

 private:
  double mean_{}, stature_{1.75};
  int samples_{0};
};

}  // namespace handsel::spark
