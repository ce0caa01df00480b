// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/stop_samples.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

CapsuleSample placed(const ChainCapsule& capsule, const std::vector<FrameMotion>& motions,
                     const Pose& T_world_base) noexcept {
  const FrameMotion& frame = motions[static_cast<std::size_t>(capsule.frame)];
  CapsuleSample sample;
  sample.a = T_world_base * (frame.p + frame.R * capsule.a);
  sample.b = T_world_base * (frame.p + frame.R * capsule.b);
  return sample;
}

StopSamples::StopSamples(const MovingChain& chain, int dof)
    : chain_(chain),
      needed_(chain.capsules().size(), 0),
      needed_frames_(chain.frames().size(), 0),
      position_(Vector::Zero(dof)),
      velocity_(Vector::Zero(dof)),
      motions_(chain.frames().size()),
      speed_(static_cast<std::size_t>(dof)),
      rest_(static_cast<std::size_t>(dof)) {
  for (auto& of_time : samples_) of_time.resize(needed_.size());
  for (auto& of_time : speeds_) of_time.resize(static_cast<std::size_t>(dof));
}

void StopSamples::clear() noexcept {
  std::fill(needed_.begin(), needed_.end(), 0);
  std::fill(needed_frames_.begin(), needed_frames_.end(), 0);
}

void StopSamples::need(std::size_t capsule) noexcept {
  needed_[capsule] = 1;
  int frame = chain_.capsules()[capsule].frame;
  while (frame >= 0 && !needed_frames_[static_cast<std::size_t>(frame)]) {
    needed_frames_[static_cast<std::size_t>(frame)] = 1;
    frame = chain_.frames()[static_cast<std::size_t>(frame)].parent;
  }
}

bool StopSamples::take(const StopPlan& stop, const Vector& position,
                       const Pose& T_world_base) noexcept {
  const double until_rest = time_until_rest(stop);
  if (until_rest == 0.0) return false;
  interval_ = until_rest / kIntervals;
  position_ = position;
  velocity_.setZero();
  std::fill(speed_.begin(), speed_.end(), 0.0);
  for (int slot = 0; slot <= kIntervals; ++slot) sample(stop, slot, T_world_base);
  speeds_known_.fill(false);
  return true;
}

/// Returns the time until all required links are at rest [s].
double StopSamples::time_until_rest(const StopPlan& stop) noexcept {
  std::fill(rest_.begin(), rest_.end(), 0.0);
  for (int k = 0; k < stop.count(); ++k)
    rest_[static_cast<std::size_t>(stop[k].axis)] = stop[k].duration;
  double last = 0.0;
  const auto add = [&](const std::vector<Lever>& levers) {
    for (const Lever& lever : levers)
      last = std::max(last, rest_[static_cast<std::size_t>(lever.axis)]);
  };
  for (std::size_t c = 0; c < needed_.size(); ++c) {
    if (!needed_[c]) continue;
    add(chain_.capsules()[c].carried);
    for (const std::vector<Lever>& finger : chain_.capsules()[c].fingers) add(finger);
  }
  return last;
}

void StopSamples::sample(const StopPlan& stop, int slot, const Pose& T_world_base) noexcept {
  for (int k = 0; k < stop.count(); ++k) {
    const AxisState s = stop[k].at(slot * interval_);
    const int axis = stop[k].axis;
    position_[axis] = s.position;
    velocity_[axis] = s.velocity;
    speed_[static_cast<std::size_t>(axis)] = std::abs(s.velocity);
  }
  chain_.move(position_, velocity_, needed_frames_, motions_);
  std::vector<CapsuleSample>& out = samples_[static_cast<std::size_t>(slot)];
  for (std::size_t c = 0; c < needed_.size(); ++c) {
    if (!needed_[c]) continue;
    const ChainCapsule& capsule = chain_.capsules()[c];
    const FrameMotion& frame = motions_[static_cast<std::size_t>(capsule.frame)];
    out[c] = placed(capsule, motions_, T_world_base);
    const Vector3 a = frame.linear + frame.angular.cross(frame.R * capsule.a);
    const Vector3 b = frame.linear + frame.angular.cross(frame.R * capsule.b);
    const double of_ends = std::sqrt(std::max(a.squaredNorm(), b.squaredNorm()));
    out[c].carried = of_ends + frame.angular.norm() * capsule.radius;
    out[c].inner = capsule.fingers.empty() ? 0.0 : capsule.inner_bound(speed_);
  }
}

const std::vector<double>& StopSamples::speeds(const StopPlan& stop, int slot) noexcept {
  const auto k = static_cast<std::size_t>(slot);
  std::vector<double>& out = speeds_[k];
  if (speeds_known_[k]) return out;
  speeds_known_[k] = true;
  std::fill(out.begin(), out.end(), 0.0);
  const double from = slot * interval_, to = (slot + 1) * interval_;
  for (int i = 0; i < stop.count(); ++i)
    out[static_cast<std::size_t>(stop[i].axis)] = stop[i].max_speed_between(from, to);
  return out;
}

}  // namespace handsel::trajectory_controller
