#include "components/trajectory_controller/hand/release_watch.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

namespace {
constexpr double kStillThere = 0.5;  // of the threshold, or of the load where that is less
constexpr double kLeastLoad = 0.4;   // [N] below this the load's share says nothing
}  // namespace

void ReleaseWatch::arm(double threshold) noexcept {
  armed_ = true;
  started_ = above_ = baseline_checked_ = false;
  grip_ = Grip::hold;
  threshold_ = threshold;
  pull_ = slack_for_ = lost_for_ = loose_for_ = 0.0;
  share_ = 1.0;
  baseline_samples_ = 0;
  baseline_ = filtered_ = quick_ = mean_ = Vector3::Zero();
}

void ReleaseWatch::bear(const Vector3& force, TimePoint now) noexcept {
  if (!force.allFinite()) return;
  const double dt = std::max(0.0, to_seconds(now - load_felt_));
  load_ = load_known_ ? Vector3(load_ + (force - load_) * (dt / (settings_.baseline_time + dt))) : force;
  load_known_ = true;
  load_felt_ = now;
}

void ReleaseWatch::filter(const Vector3& force, double dt) noexcept {
  filtered_ += (force - baseline_ - filtered_) * (dt / (settings_.filter_time + dt));
  quick_ += (force - baseline_ - quick_) * (dt / (settings_.quick_time + dt));
  pull_ = filtered_.norm();
  const double load = baseline_.norm();
  share_ = load > kLeastLoad ? (quick_ + baseline_).norm() / load : 1.0;
}

/// A pull beyond the threshold, in one direction, not away from the person; above_since_ says since when.
bool ReleaseWatch::strong(const Vector3& toward, TimePoint now) noexcept {
  const Vector3 direction = pull_ > 1e-9 ? Vector3(filtered_ / pull_) : Vector3(Vector3::Zero());
  // The quick filter must agree: after a bump the slow one is still high for a while.
  const bool beyond =
      pull_ >= threshold_ && quick_.dot(direction) >= kStillThere * threshold_ && direction.dot(toward) >= settings_.away_cosine;
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
  if (to_seconds(now - first_) < settings_.baseline_time || baseline_samples_ == 0) {
    baseline_ += (felt.force - baseline_) / ++baseline_samples_;
    return grip_;
  }
  if (!baseline_checked_) {
    baseline_checked_ = true;
    if (load_known_ && felt.person_near && (baseline_ - load_).norm() >= threshold_) baseline_ = load_;
  }
  filter(felt.force, dt);
  const bool pulled = strong(felt.toward, now);
  const double lasted = pulled ? to_seconds(now - above_since_) : 0.0;
  if (pulled) impulse_ += dt * pull_;
  if (grip_ == Grip::hold) {
    if (pulled && felt.person_near && lasted >= settings_.hold_time && impulse_ >= settings_.impulse) {
      grip_ = Grip::loosen;
      loose_for_ = lost_for_ = slack_for_ = 0.0;
    }
    return grip_;
  }
  // The load hangs on the hand as before, and nobody pulls.
  const double load = baseline_.norm();
  const bool back = quick_.norm() < kStillThere * (load > kLeastLoad ? std::min(threshold_, load) : threshold_);
  lost_for_ = back ? lost_for_ + dt : 0.0;
  if (lost_for_ >= settings_.lost_time && (grip_ == Grip::loosen || felt.pressing)) {
    ++regrips_;
    close_again();
    return grip_;
  }
  if (grip_ == Grip::open) return grip_;
  loose_for_ += dt;
  slack_for_ = share_ < settings_.slack_share ? slack_for_ + dt : 0.0;
  if (lasted >= settings_.commit_time || slack_for_ >= settings_.slack_time)
    grip_ = Grip::open;
  else if (loose_for_ >= settings_.patience)
    arm(threshold_);
  return grip_;
}

}  // namespace handsel::trajectory_controller
