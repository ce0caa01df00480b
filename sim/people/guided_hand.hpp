// A hand that goes where somebody outside wants it. Pure: time is an argument.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

/// Moves toward a goal with bounded speed and acceleration, and comes to rest there. Own method:
/// the wanted velocity points at the goal and permits a stop there.
class GuidedHand {
 public:
  static constexpr double kMaxSpeed = 1.2;         ///< [m/s]
  static constexpr double kMaxAcceleration = 8.0;  ///< [m/s^2]

  /// Begins at `position` with `velocity`, world [m], [m/s].
  GuidedHand(const Vector3& position, const Vector3& velocity)
      : position_(position), velocity_(velocity) {}

  /// Wants the hand at `point`, world [m], until the time `until` [s].
  void guide(const Vector3& point, double until) {
    point_ = point;
    until_ = until;
  }
  /// Returns whether somebody wants the hand at point() at the time `now` [s].
  bool is_guided(double now) const { return now < until_; }
  /// Returns where the hand is wanted, world [m].
  const Vector3& point() const { return point_; }
  /// Returns where the hand is, world [m].
  const Vector3& position() const { return position_; }

  /// Moves by dt [s] toward `goal`, world [m]. Returns whether the hand rests there.
  bool step(double dt, const Vector3& goal) {
    constexpr double kApproachTime = 0.05;  // time constant of the end of a motion [s]
    constexpr double kArrived = 1e-6;       // [m]
    const Vector3 to = goal - position_;
    const double distance = to.norm();
    // Half the acceleration is left for a goal that moves.
    const double speed =
        std::min({kMaxSpeed, std::sqrt(kMaxAcceleration * distance), distance / kApproachTime});
    const Vector3 change = speed * to.stableNormalized() - velocity_;
    const double max_change = kMaxAcceleration * dt;
    velocity_ += std::min(1.0, max_change / std::max(change.norm(), 1e-12)) * change;
    position_ += dt * velocity_;
    return distance < kArrived;
  }

 private:
  Vector3 position_, velocity_, point_{Vector3::Zero()};
  double until_{0};
};

}  // namespace handsel::sim
