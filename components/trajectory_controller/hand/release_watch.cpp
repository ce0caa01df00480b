// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/hand/release_watch.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

void ReleaseWatch::arm(double threshold) noexcept {
  armed_ = true;
  started_ = above_ = false;
  grip_ = Grip::hold;
  threshold_ = threshold;
  slack_for_ = lost_for_ = loose_for_ = 0.0;
  mean_ = Vector3::Zero();
  filter_.reset();
}

/// Returns whether a pull exceeds the threshold in one direction that does not lead away from the
/// person; above_since_ is its start.
bool ReleaseWatch::strong(const Vector3& toward, TimePoint now) noexcept {
  const double pull = filter_.pull();
  const Vector3 direction =
      pull > 1e-9 ? Vector3(filter_.filtered() / pull) : Vector3(Vector3::Zero());
  // The fast filter must agree: after a bump the slow one stays high for a while.
  const bool lasts = filter_.quick().dot(direction) >= settings_.lasts_fraction * threshold_;
  const bool toward_person = direction.dot(toward) >= settings_.away_cosine;
  const bool beyond = pull >= threshold_ && lasts && toward_person;
  if (!beyond || (above_ && direction.dot(mean_.normalized()) < settings_.direction_cosine)) {
    above_ = false;
    return false;
  }
  if (!above_) {
    above_ = true;
    above_since_ = now;
    impulse_ = 0.0;
    mean_ = Vector3::Zero();
  }
  mean_ += direction;
  return true;
}

void ReleaseWatch::close_again() noexcept {
  grip_ = Grip::hold;
  above_ = false;
  lost_for_ = slack_for_ = 0.0;
}

Grip ReleaseWatch::update(const Felt& felt, TimePoint now) noexcept {
  if (!armed_ || !felt.force.allFinite()) return grip_;
  if (!started_) {
    started_ = true;
    first_ = last_ = now;
  }
  const double dt = std::max(0.0, to_seconds(now - last_));
  last_ = now;
  if (to_seconds(now - first_) < settings_.baseline_time || !filter_.averaged()) {
    filter_.average(felt.force);
    return grip_;
  }
  filter_.check_baseline(felt.person_near, threshold_);
  filter_.update(felt.force, dt);
  const bool pulled = strong(felt.toward, now);
  const double lasted = pulled ? to_seconds(now - above_since_) : 0.0;
  if (pulled) impulse_ += dt * filter_.pull();
  if (grip_ == Grip::hold) {
    if (pulled && felt.person_near && lasted >= settings_.hold_time &&
        impulse_ >= settings_.impulse) {
      grip_ = Grip::loosen;
      loose_for_ = lost_for_ = slack_for_ = 0.0;
    }
    return grip_;
  }
  // The load hangs on the hand as before, without a pull.
  const double load = filter_.load();
  const double reference = load > settings_.min_load ? std::min(threshold_, load) : threshold_;
  const bool back = filter_.quick().norm() < settings_.lasts_fraction * reference;
  lost_for_ = back ? lost_for_ + dt : 0.0;
  if (lost_for_ >= settings_.lost_time && (grip_ == Grip::loosen || felt.pressing)) {
    ++regrips_;
    close_again();
    return grip_;
  }
  if (grip_ == Grip::open) return grip_;
  loose_for_ += dt;
  slack_for_ = filter_.load_ratio() < settings_.slack_fraction ? slack_for_ + dt : 0.0;
  if (lasted >= settings_.commit_time || slack_for_ >= settings_.slack_time)
    grip_ = Grip::open;
  else if (loose_for_ >= settings_.timeout)
    arm(threshold_);
  return grip_;
}

}  // namespace handsel::trajectory_controller
