// SPDX-License-Identifier: Apache-2.0
// The reachable volume of one arm with its comfort cost, computed once per body size and moved with
// the person (chapter section 4.1.2).
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"

namespace handsel::costmap {

class ComfortVolume {
 public:
  ComfortVolume() = default;
  ComfortVolume(const ArmSize& arm, double resolution);

  /// Returns whether the volume is of an arm whose lengths differ by less than `tolerance` [m].
  bool suits(const ArmSize& arm, double tolerance) const;
  /// Returns the interpolated comfort cost at a point relative to the shoulder, along forward,
  /// outward, up of the torso [m]; 1 if the majority of neighbouring points is out of reach.
  double cost(const Vector3& p_arm) const;

 private:
  struct Point {
    float cost, reachable;  // both 0 out of reach
  };
  ArmSize arm_;
  double resolution_{1};
  int half_{0}, size_{0};
  std::vector<Point> points_;
};

}  // namespace handsel::costmap
