// SPDX-License-Identifier: Apache-2.0
// A hand that goes where somebody outside wants it. Pure: time is an argument.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/geometry/pose.hpp"
#include "sim/people/person_settings.hpp"

namespace handsel::sim {

/// Moves toward a goal with bounded speed and acceleration, and comes to rest there. Own method:
/// the wanted velocity points at the goal and permits a stop there.
class GuidedHand {
 public:
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

  /// Moves by dt [s] toward `goal`, world [m], within the max speed and acceleration given.
  /// Returns whether the hand rests there.
  bool step(double dt, const Vector3& goal, const PersonManners& manners) {
    constexpr double kArrived = 1e-6;  // [m]
    const Vector3 to = goal - position_;
    const double distance = to.norm();
    // Half the acceleration is left for a goal that moves.
    const double speed =
        std::min({manners.guided_max_speed, std::sqrt(manners.guided_max_acceleration * distance),
                  distance / manners.guided_settle_time});
    const Vector3 change = speed * to.stableNormalized() - velocity_;
    const double max_change = manners.guided_max_acceleration * dt;
    velocity_ += std::min(1.0, max_change / std::max(change.norm(), 1e-12)) * change;
    position_ += dt * velocity_;
    return distance < kArrived;
  }

 private:
  Vector3 position_, velocity_, point_{Vector3::Zero()};
  double until_{0};
};

}  // namespace handsel::sim
