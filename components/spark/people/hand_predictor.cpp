#include "components/spark/people/hand_predictor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::spark {
namespace {

constexpr FadingModel kHandModel{0.15, 0.04, 1.2, 4};
constexpr FadingModel kTrunkModel{1, 0.04, 1, 0};
constexpr double kRadiusDeviations = 4;      // radius of the sphere [standard deviations]
constexpr double kMeanNoise = 0.5;           // noise of the trunk's mean, divided by a joint's
constexpr double kCheckHorizon = 0.2;        // horizon of the predictions that are checked [s]
constexpr double kErrorMargin = 1.2;         // factor of the radius beyond an observed error
constexpr double kErrorMemory = 2;           // time constant of the factor's decay [s]
constexpr std::size_t kMaxPredictions = 64;  // max number of predictions waiting for comparison

}  // namespace

HandPredictor::HandPredictor() : hand_(kHandModel), trunk_(kTrunkModel) {}

void HandPredictor::reset(const Vector3& hand, const Vector3& trunk, double noise) {
  trunk_.reset(trunk, kMeanNoise * noise);
  hand_.reset(hand - trunk, noise);
  clock_ = 0;
  predictions_.clear();
}

void HandPredictor::update(const Vector3& hand, const Vector3& trunk, double dt, double noise) {
  trunk_.update(trunk, dt, kMeanNoise * noise);
  hand_.update(hand - trunk, dt, noise);
  clock_ += dt;
  error_factor_ = 1 + (error_factor_ - 1) * std::exp(-dt / kErrorMemory);
  const Vector3 p_hand = hand_.at(0).position + trunk_.at(0).position;
  for (; !predictions_.empty() && predictions_.front().due <= clock_; predictions_.pop_front()) {
    const Ball& ball = predictions_.front().ball;
    error_factor_ =
        std::max(error_factor_, kErrorMargin * (ball.centre - p_hand).norm() / ball.radius);
  }
  if (predictions_.size() < kMaxPredictions)
    predictions_.push_back({clock_ + kCheckHorizon, at(kCheckHorizon, 1)});
}

HandPredictor::Ball HandPredictor::at(double horizon, double factor) const {
  const FadingMotion::Expected hand = hand_.at(horizon), trunk = trunk_.at(horizon);
  return {hand.position + trunk.position,
          factor * kRadiusDeviations * std::hypot(hand.deviation, trunk.deviation)};
}

}  // namespace handsel::spark
