// SPDX-License-Identifier: Apache-2.0
// Where an object was during the last seconds, and whether it has come to rest. Pure.
#pragma once

#include <deque>
#include <utility>

#include "common/base/time.hpp"
#include "common/config/settings/manipulation_planner.hpp"
#include "common/geometry/pose.hpp"

namespace handsel::manipulation_planner {

/// Positions of an object over time. An object that turns back at once is as slow at the turning
/// point as one that comes to rest there. How long this takes follows from the last part of its
/// path: minimum-jerk motions (Flash and Hogan 1985) come near their end with the cube of the time
/// that is left. Own method.
class ObjectTrail {
 public:
  /// `settings` must outlive what is made.
  explicit ObjectTrail(const settings::ManipulationPlannerSettings& settings)
      : settings_(settings) {}

  /// Adds the position of the object as observed at `seen`, world [m]. What is not newer than the
  /// last position is left out.
  void add(TimePoint seen, const Vector3& p_world);

  /// Returns for how long the object has been within the noise of its newest position [s].
  double rest() const;
  /// Returns the rest after which an object that turns back would have moved away again [s].
  double turning_time() const;
  /// Returns how far the object has moved back, against the last part of its path, within the last
  /// moments of the rest [m].
  double retreat() const;
  /// Returns the standard deviation of the observed positions from noise, as far as measured [m].
  double noise() const { return noise_; }
  /// Returns the direction of the last part of the path, world; zero: the object was at rest all
  /// the time.
  Vector3 arrival() const;
  /// Returns how much longer the path was than the straight one, within the second before the
  /// rest [m].
  double detour() const;

 private:
  std::size_t last_beyond(double radius) const;
  std::size_t before_arrival() const;
  void measure_noise();
  double tremor() const;

  const settings::ManipulationPlannerSettings& settings_;
  std::deque<std::pair<TimePoint, Vector3>> places_;  // oldest first
  double noise_{};
};

}  // namespace handsel::manipulation_planner
