// Velocity of one noisy point: a constant-velocity Kalman filter, quick when the point surprises
// it. Pure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/pose.hpp"

namespace handsel::spark {

class JointMotion {
 public:
  /// Standard deviations of its acceleration, on each axis [m/s^2]: as usual, and when it
  /// surprises.
  struct Agility {
    double calm, sudden;  ///< as usual; when a position is off by two standard deviations
  };
  explicit JointMotion(const Agility& agility) : agility_(agility) {}
  const Vector3& velocity() const { return velocity_; }  ///< world [m/s]
  /// Starts at a position with standard deviation `noise` of each axis [m], at rest.
  void reset(const Vector3& position, double noise) {
    position_ = position;
    velocity_.setZero();
    pp_ = noise * noise;
    pv_ = 0;
    vv_ = 1.0;
  }
  /// `dt` > 0 [s] since the last sample, `noise` of this one [m].
  void update(const Vector3& seen, double dt, double noise) {
    const Vector3 expected = position_ + dt * velocity_;
    const double r = noise * noise;
    const auto predicted = [&](double acceleration) {
      const double q = acceleration * acceleration * dt * dt;
      return std::array<double, 3>{pp_ + 2 * dt * pv_ + dt * dt * vv_ + q * dt * dt / 4,
                                   pv_ + dt * vv_ + q * dt / 2, vv_ + q};
    };
    auto p = predicted(agility_.calm);
    const Vector3 surprise = seen - expected;
    if (surprise.squaredNorm() > 3 * kSurprise * kSurprise * (p[0] + r))
      p = predicted(agility_.sudden);
    const double gain = p[0] / (p[0] + r), gain_velocity = p[1] / (p[0] + r);
    position_ = expected + gain * surprise;
    velocity_ += gain_velocity * surprise;
    pp_ = (1 - gain) * p[0];
    pv_ = (1 - gain) * p[1];
    vv_ = std::min(p[2] - gain_velocity * p[1], 25.0);
  }

 private:
  static constexpr double kSurprise = 2;  // standard deviations
  Agility agility_;
  Vector3 position_{Vector3::Zero()}, velocity_{Vector3::Zero()};
  double pp_{0}, pv_{0}, vv_{1};
};

}  // namespace handsel::spark
