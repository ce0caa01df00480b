#include "components/spark/people/hand_predictor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::spark {
namespace {

constexpr FadingModel kHand{0.15, 0.04, 1.2, 4};
constexpr FadingModel kTrunk{1, 0.04, 1, 0};
constexpr double kSure = 4;    // standard deviations in the radius
constexpr double kMean = 0.5;  // of several joints is so much less noisy
constexpr double kChecked =
    0.2;  // what was expected of this moment, so long ago, is compared with what came [s]
constexpr double kMargin =
    1.2;  // a ball that was missed is made larger than would have sufficed by this factor
constexpr double kMemory = 2;      // and shrinks again within [s]
constexpr std::size_t kMost = 64;  // promises kept

}  // namespace

HandPredictor::HandPredictor() : hand_(kHand), trunk_(kTrunk) {}

void HandPredictor::reset(const Vector3& hand, const Vector3& trunk, double noise) {
  trunk_.reset(trunk, kMean * noise);
  hand_.reset(hand - trunk, noise);
  clock_ = 0;
  promises_.clear();
}

void HandPredictor::update(const Vector3& hand, const Vector3& trunk, double dt, double noise) {
  trunk_.update(trunk, dt, kMean * noise);
  hand_.update(hand - trunk, dt, noise);
  clock_ += dt;
  misses_ = 1 + (misses_ - 1) * std::exp(-dt / kMemory);
  const Vector3 is = hand_.at(0).position + trunk_.at(0).position;
  for (; !promises_.empty() && promises_.front().due <= clock_; promises_.pop_front()) {
    const Ball& ball = promises_.front().ball;
    misses_ = std::max(misses_, kMargin * (ball.centre - is).norm() / ball.radius);
  }
  if (promises_.size() < kMost) promises_.push_back({clock_ + kChecked, at(kChecked, 1)});
}

HandPredictor::Ball HandPredictor::at(double horizon, double factor) const {
  const FadingMotion::Expected hand = hand_.at(horizon), trunk = trunk_.at(horizon);
  return {hand.position + trunk.position,
          factor * kSure * std::hypot(hand.deviation, trunk.deviation)};
}

}  // namespace handsel::spark
