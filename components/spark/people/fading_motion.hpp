// Where a noisy point is, and where it will be: position, a velocity that fades and an acceleration
// that fades faster. Pure.
#pragma once

#include "common/geometry/pose.hpp"

namespace handsel::spark {

/// What a point is taken to do without further acceleration: a reach ends, a walk continues.
struct FadingModel {
  double velocity_time{};           ///< the velocity fades within [s]
  double acceleration_time{};       ///< the acceleration fades within [s]
  double acceleration{};            ///< standard deviation, of each axis [m/s^2]
  double acceleration_per_speed{};  ///< and more the faster it is [1/s]
};

/// Singer's model of manoeuvring points (1970) with a velocity that fades as well, so that a
/// prediction lands where a minimum-jerk motion of this speed would end, by a Kalman filter that is
/// the same for every axis. Own method, for that end.
class FadingMotion {
 public:
  struct Expected {
    Vector3 position{Vector3::Zero()};  ///< [m]
    double deviation{};                 ///< standard deviation of each axis [m]
  };

  explicit FadingMotion(const FadingModel& model) : model_(model) {}
  /// Starts at a position with standard deviation `noise` of each axis [m], at rest.
  void reset(const Vector3& position, double noise);
  /// `dt` > 0 [s] since the last sample, `noise` of this one [m].
  void update(const Vector3& seen, double dt, double noise);
  /// `horizon` >= 0 after the last sample [s].
  Expected at(double horizon) const;

 private:
  FadingModel model_;
  Vector3 position_{Vector3::Zero()}, velocity_{Vector3::Zero()}, acceleration_{Vector3::Zero()};
  Eigen::Matrix3d covariance_{Eigen::Matrix3d::Zero()};
};

}  // namespace handsel::spark
