// SPDX-License-Identifier: Apache-2.0
// Estimates and predicts the motion of a noisy point: position, a decaying velocity and a faster
// decaying acceleration. Pure.
#pragma once

#include "common/geometry/pose.hpp"

namespace handsel::spark {

/// The motion model of a point: time constants and accelerations.
struct FadingModel {
  double velocity_time{};           ///< time constant of the velocity [s]
  double acceleration_time{};       ///< time constant of the acceleration [s]
  double acceleration{};            ///< standard deviation on each axis [m/s^2]
  double acceleration_per_speed{};  ///< increase per speed [1/s]
  double usual_deviations{};        ///< max innovation of usual motion [standard deviations]
  double sudden_factor{};           ///< of the acceleration at a larger innovation
  double initial_speed{};           ///< standard deviation of the first velocity [m/s]
};

/// Filters with Singer's model of manoeuvring points (1970), extended by a decaying velocity, in a
/// Kalman filter that is the same for every axis. Own method: so a prediction ends where a
/// minimum-jerk motion of this speed ends.
class FadingMotion {
 public:
  struct Expected {
    Vector3 position{Vector3::Zero()};  ///< [m]
    double deviation{};                 ///< standard deviation on each axis [m]
  };

  /// Restarts at a position with standard deviation `noise` on each axis [m], at rest. Must come
  /// before update() and at().
  void reset(const FadingModel& model, const Vector3& position, double noise);
  /// Takes a sample. `dt`: time since the last sample, > 0 [s]; `noise`: standard deviation [m].
  void update(const Vector3& seen, double dt, double noise);
  /// Predicts the point at `horizon` >= 0 after the last sample [s].
  Expected at(double horizon) const;

 private:
  FadingModel model_;
  Vector3 position_{Vector3::Zero()}, velocity_{Vector3::Zero()}, acceleration_{Vector3::Zero()};
  Eigen::Matrix3d covariance_{Eigen::Matrix3d::Zero()};
};

}  // namespace handsel::spark
