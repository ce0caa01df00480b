// SPDX-License-Identifier: Apache-2.0
#include "components/spark/people/fading_motion.hpp"

#include <cmath>

namespace handsel::spark {
namespace {

/// Returns the effect of a present acceleration after `h` [s] on position, velocity and
/// acceleration.
Vector3 response(const FadingModel& m, double h) {
  const double v = std::exp(-h / m.velocity_time), a = std::exp(-h / m.acceleration_time);
  const double rate = 1 / m.acceleration_time - 1 / m.velocity_time;
  return {(m.velocity_time * (1 - v) - m.acceleration_time * (1 - a)) / rate, (v - a) / rate, a};
}

Eigen::Matrix3d transition(const FadingModel& m, double h) {
  Eigen::Matrix3d out = Eigen::Matrix3d::Identity();
  out(0, 1) = m.velocity_time * -std::expm1(-h / m.velocity_time);
  out(1, 1) = std::exp(-h / m.velocity_time);
  out.col(2) = response(m, h);
  return out;
}

/// Returns the covariance added by random accelerations within `h` [s], by Simpson's rule over
/// time.
Eigen::Matrix3d process_noise(const FadingModel& m, double h, double acceleration) {
  constexpr int kParts = 8;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i <= kParts; ++i) {
    const Vector3 g = response(m, h * i / kParts);
    sum += (i == 0 || i == kParts ? 1.0 : i % 2 ? 4.0 : 2.0) * g * g.transpose();
  }
  return 2 * acceleration * acceleration / m.acceleration_time * h / (3.0 * kParts) * sum;
}

}  // namespace

void FadingMotion::reset(const FadingModel& model, const Vector3& position, double noise) {
  model_ = model;
  position_ = position;
  velocity_.setZero();
  acceleration_.setZero();
  covariance_ = Vector3(noise * noise, model_.initial_speed * model_.initial_speed,
                        model_.acceleration * model_.acceleration)
                    .asDiagonal();
}

void FadingMotion::update(const Vector3& seen, double dt, double noise) {
  const Eigen::Matrix3d A = transition(model_, dt);
  const double acceleration =
      model_.acceleration + model_.acceleration_per_speed * velocity_.norm();
  const Vector3 position = position_ + A(0, 1) * velocity_ + A(0, 2) * acceleration_;
  const Vector3 velocity = A(1, 1) * velocity_ + A(1, 2) * acceleration_,
                innovation = seen - position;
  const Eigen::Matrix3d propagated = A * covariance_ * A.transpose();
  Eigen::Matrix3d P = propagated + process_noise(model_, dt, acceleration);
  const double usual = model_.usual_deviations;
  if (innovation.squaredNorm() > 3 * usual * usual * (P(0, 0) + noise * noise))
    P = propagated + process_noise(model_, dt, model_.sudden_factor * acceleration);
  const Vector3 gain = P.col(0) / (P(0, 0) + noise * noise);
  position_ = position + gain.x() * innovation;
  velocity_ = velocity + gain.y() * innovation;
  acceleration_ = A(2, 2) * acceleration_ + gain.z() * innovation;
  covariance_ = P - gain * P.row(0);
}

FadingMotion::Expected FadingMotion::at(double horizon) const {
  const Eigen::Matrix3d A = transition(model_, horizon);
  const Eigen::Matrix3d P =
      A * covariance_ * A.transpose() +
      process_noise(model_, horizon,
                    model_.acceleration + model_.acceleration_per_speed * velocity_.norm());
  return {position_ + A(0, 1) * velocity_ + A(0, 2) * acceleration_, std::sqrt(P(0, 0))};
}

}  // namespace handsel::spark
