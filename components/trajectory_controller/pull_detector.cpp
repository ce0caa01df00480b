#include "components/trajectory_controller/pull_detector.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

namespace {
constexpr double kStillThere = 0.5;  // of the threshold
}

void PullDetector::arm(double threshold) noexcept {
  armed_ = true;
  started_ = above_ = false;
  threshold_ = threshold;
  pull_ = 0.0;
  baseline_samples_ = 0;
  baseline_ = filtered_ = quick_ = mean_ = Vector3::Zero();
}

bool PullDetector::update(const Vector3& force, const Vector3& toward, TimePoint now) noexcept {
  if (!armed_ || !force.allFinite()) return false;
  if (!started_) {
    started_ = true;
    first_ = last_ = now;
  }
  if (to_seconds(now - first_) < settings_.baseline_time || baseline_samples_ == 0) {
    ++baseline_samples_;
    baseline_ += (force - baseline_) / baseline_samples_;
    last_ = now;
    return false;
  }
  const double dt = std::max(0.0, to_seconds(now - last_));
  last_ = now;
  filtered_ += (force - baseline_ - filtered_) * (dt / (settings_.filter_time + dt));
  quick_ += (force - baseline_ - quick_) * (dt / (settings_.quick_time + dt));
  pull_ = filtered_.norm();

  const Vector3 direction = pull_ > 1e-9 ? Vector3(filtered_ / pull_) : Vector3(Vector3::Zero());
  // The quick filter must agree: after a bump the slow one is still high for a while.
  const bool strong =
      pull_ >= threshold_ && quick_.dot(direction) >= kStillThere * threshold_ && direction.dot(toward) >= settings_.away_cosine;
  if (!strong || (above_ && direction.dot(mean_.normalized()) < settings_.direction_cosine)) {
    above_ = false;
    return false;
  }
  if (!above_) {
    above_ = true;
    above_since_ = now;
    mean_ = Vector3::Zero();
  }
  mean_ += direction;
  return to_seconds(now - above_since_) >= settings_.hold_time;
}

bool PullDetector::lost() const noexcept { return quick_.norm() < kStillThere * threshold_; }

}  // namespace handsel::trajectory_controller
