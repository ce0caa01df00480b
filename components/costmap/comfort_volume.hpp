// The reachable volume of one arm and its comfort, computed once for a body size and moved with the
// person (chapter section 4.1.2).
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"

namespace handsel::costmap {

class ComfortVolume {
 public:
  ComfortVolume() = default;
  ComfortVolume(const ArmSize& arm, double resolution);

  /// Made for an arm whose lengths differ by less than `tolerance` [m] from these.
  bool suits(const ArmSize& arm, double tolerance) const;
  /// Comfort cost at p from the shoulder along (forward, outward, up) of the torso [m],
  /// interpolated; 1 where most of the neighbouring points of the volume are out of reach.
  double cost(const Vector3& p_arm) const;

 private:
  struct Point {
    float cost, reachable;  // 0, 0 out of reach
  };
  ArmSize arm_;
  double resolution_{1};
  int half_{0}, size_{0};
  std::vector<Point> points_;
};

}  // namespace handsel::costmap
