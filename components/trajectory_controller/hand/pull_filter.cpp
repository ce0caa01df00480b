// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/hand/pull_filter.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

void PullFilter::bear(const Vector3& force, TimePoint now) noexcept {
  if (!force.allFinite()) return;
  const double dt = std::max(0.0, to_seconds(now - load_felt_));
  const double weight = dt / (settings_.baseline_time + dt);
  load_ = load_known_ ? Vector3(load_ + (force - load_) * weight) : force;
  load_known_ = true;
  load_felt_ = now;
}

void PullFilter::reset() noexcept {
  baseline_checked_ = false;
  pull_ = 0.0;
  load_ratio_ = 1.0;
  samples_ = 0;
  baseline_ = filtered_ = quick_ = Vector3::Zero();
}

void PullFilter::average(const Vector3& force) noexcept {
  baseline_ += (force - baseline_) / ++samples_;
}

void PullFilter::check_baseline(bool person_near, double threshold) noexcept {
  if (baseline_checked_) return;
  baseline_checked_ = true;
  if (load_known_ && person_near && (baseline_ - load_).norm() >= threshold) baseline_ = load_;
}

void PullFilter::update(const Vector3& force, double dt) noexcept {
  filtered_ += (force - baseline_ - filtered_) * (dt / (settings_.filter_time + dt));
  quick_ += (force - baseline_ - quick_) * (dt / (settings_.quick_time + dt));
  pull_ = filtered_.norm();
  load_ratio_ = load() > settings_.min_load ? (quick_ + baseline_).norm() / load() : 1.0;
}

}  // namespace handsel::trajectory_controller
