// SPDX-License-Identifier: Apache-2.0
// Estimates the velocity of one noisy point: a constant-velocity Kalman filter with increased gain
// at large innovations. Pure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/pose.hpp"

namespace handsel::spark {

class JointMotion {
 public:
  struct Model {
    /// Standard deviations of the acceleration on each axis [m/s^2], for small and for large
    /// innovations.
    double usual{}, sudden{};
    double usual_deviations{};  ///< max innovation of usual motion [standard deviations]
    double initial_speed{};     ///< standard deviation of the first velocity on each axis [m/s]
  };
  const Vector3& velocity() const { return velocity_; }  ///< world [m/s]
  /// Restarts at a position with standard deviation `noise` on each axis [m], at rest. Must come
  /// before update().
  void reset(const Model& model, const Vector3& position, double noise) {
    model_ = model;
    position_ = position;
    velocity_.setZero();
    pp_ = noise * noise;
    pv_ = 0;
    vv_ = model_.initial_speed * model_.initial_speed;
  }
  /// Takes a sample. `dt`: time since the last sample, > 0 [s]; `noise`: standard deviation [m].
  void update(const Vector3& seen, double dt, double noise) {
    const Vector3 expected = position_ + dt * velocity_;
    const double r = noise * noise;
    const auto predicted = [&](double acceleration) {
      const double q = acceleration * acceleration * dt * dt;
      return std::array<double, 3>{pp_ + 2 * dt * pv_ + dt * dt * vv_ + q * dt * dt / 4,
                                   pv_ + dt * vv_ + q * dt / 2, vv_ + q};
    };
    auto p = predicted(model_.usual);
    const Vector3 innovation = seen - expected;
    const double usual = model_.usual_deviations;
    if (innovation.squaredNorm() > 3 * usual * usual * (p[0] + r)) p = predicted(model_.sudden);
    const double gain = p[0] / (p[0] + r), gain_velocity = p[1] / (p[0] + r);
    position_ = expected + gain * innovation;
    velocity_ += gain_velocity * innovation;
    pp_ = (1 - gain) * p[0];
    pv_ = (1 - gain) * p[1];
    vv_ = std::min(p[2] - gain_velocity * p[1], 25.0);
  }

 private:
  Model model_;
  Vector3 position_{Vector3::Zero()}, velocity_{Vector3::Zero()};
  double pp_{0}, pv_{0}, vv_{0};
};

}  // namespace handsel::spark
