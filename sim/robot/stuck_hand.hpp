// SPDX-License-Identifier: Apache-2.0
// An injected fault: a hand that does not open.
#pragma once

#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

/// References of the robot's servos, all axes.
struct Reference {
  Vector position, velocity, acceleration, effort;  ///< [rad], [rad/s], [rad/s^2], [Nm] ([m], ...)
};

/// Keeps the fingers closed, regardless of the set-points, once they hold an object and have been
/// at rest for 0.5 s.
class StuckHand {
 public:
  /// `axes`: axes of the fingers.
  explicit StuckHand(std::vector<int> axes) : axes_(std::move(axes)) {}

  /// Replaces the fingers' part of `reference`. `dt`: time since the last call [s].
  void apply(double dt, bool holds_object, Reference& reference);

 private:
  std::vector<int> axes_;
  Vector position_, effort_;  // held by the fingers
  double at_rest_{};          // time at rest [s]
  bool stuck_{};
};

}  // namespace handsel::sim
