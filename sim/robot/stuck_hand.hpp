// An injected fault: a hand that does not open again.
#pragma once

#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

/// What the servos of a robot follow, all axes.
struct Reference {
  Vector position, velocity, acceleration, effort;  ///< [rad], [rad/s], [rad/s^2], [Nm] ([m], ...)
};

/// Keeps the fingers closed once they hold an object and have been at rest for half a second,
/// whatever the set-points ask for.
class StuckHand {
 public:
  /// `axes`: of the fingers.
  explicit StuckHand(std::vector<int> axes) : axes_(std::move(axes)) {}

  /// Replaces the fingers' part of `reference`. `dt`: since the last call [s].
  void apply(double dt, bool holds_object, Reference& reference);

 private:
  std::vector<int> axes_;
  Vector position_, effort_;  // kept by the fingers
  double at_rest_{};          // [s]
  bool stuck_{};
};

}  // namespace handsel::sim
