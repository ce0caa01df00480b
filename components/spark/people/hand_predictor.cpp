// SPDX-License-Identifier: Apache-2.0
#include "components/spark/people/hand_predictor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::spark {
namespace {

constexpr std::size_t kMaxPredictions = 64;  // max number of predictions waiting for comparison

FadingModel hand_model(const HandPredictor::Settings& s) {
  return {s.predicted_hand_velocity_time, s.predicted_hand_acceleration_time,
          s.predicted_hand_acceleration,  s.predicted_hand_acceleration_per_speed,
          s.predicted_usual_deviations,   s.predicted_sudden_factor,
          s.predicted_initial_speed};
}

FadingModel trunk_model(const HandPredictor::Settings& s) {
  return {s.predicted_trunk_velocity_time, s.predicted_trunk_acceleration_time,
          s.predicted_trunk_acceleration,  0,
          s.predicted_usual_deviations,    s.predicted_sudden_factor,
          s.predicted_initial_speed};
}

}  // namespace

void HandPredictor::reset(const Vector3& hand, const Vector3& trunk, double noise,
                          const Settings& settings) {
  settings_ = settings;
  trunk_.reset(trunk_model(settings_), trunk, settings_.trunk_noise * noise);
  hand_.reset(hand_model(settings_), hand - trunk, noise);
  clock_ = 0;
  predictions_.clear();
}

void HandPredictor::update(const Vector3& hand, const Vector3& trunk, double dt, double noise) {
  trunk_.update(trunk, dt, settings_.trunk_noise * noise);
  hand_.update(hand - trunk, dt, noise);
  clock_ += dt;
  error_factor_ = 1 + (error_factor_ - 1) * std::exp(-dt / settings_.hand_error_memory);
  const Vector3 p_hand = hand_.at(0).position + trunk_.at(0).position;
  for (; !predictions_.empty() && predictions_.front().due <= clock_; predictions_.pop_front()) {
    const Ball& ball = predictions_.front().ball;
    error_factor_ = std::max(
        error_factor_, settings_.hand_error_margin * (ball.centre - p_hand).norm() / ball.radius);
  }
  if (predictions_.size() < kMaxPredictions)
    predictions_.push_back(
        {clock_ + settings_.prediction_check_horizon, at(settings_.prediction_check_horizon, 1)});
}

HandPredictor::Ball HandPredictor::at(double horizon, double factor) const {
  const FadingMotion::Expected hand = hand_.at(horizon), trunk = trunk_.at(horizon);
  return {hand.position + trunk.position,
          factor * settings_.hand_deviations * std::hypot(hand.deviation, trunk.deviation)};
}

}  // namespace handsel::spark
