// SPDX-License-Identifier: Apache-2.0
#include "sim/people/followed_body.hpp"

#include <algorithm>

#include "sim/people/person_parts.hpp"

namespace handsel::sim {

FollowedBody::FollowedBody(const BodyPoints& start, double stature, const PersonManners& manners)
    : manners_(manners), from_(start), to_(start) {
  fitted_.stature = stature;
}

bool FollowedBody::observe(const ObservedPerson& seen, double now) {
  std::vector<BodyJoint> joints = fit_body(seen, has_sample_ ? &fitted_ : nullptr, fitted_.stature);
  if (joints.size() != to_.size()) return false;
  fitted_.joints = std::move(joints);
  BodyPoints here;
  sample(now, here);
  for (std::size_t i = 0; i < to_.size(); ++i) to_[i] = fitted_.joints[i].position;
  const double distance = (to_[kWaist] - here[kWaist]).norm();
  const bool placed =
      !has_sample_ || distance > std::max(manners_.external_min_jump,
                                          manners_.external_max_speed * (now - motion_start_));
  from_ = placed ? to_ : here;
  motion_duration_ = placed ? manners_.external_min_motion
                            : std::clamp(now - motion_start_, manners_.external_min_motion,
                                         manners_.external_max_motion);
  motion_start_ = now;
  has_sample_ = true;
  return placed;
}

void FollowedBody::sample(double now, BodyPoints& out) const {
  const double fraction =
      motion_duration_ > 0 ? std::clamp((now - motion_start_) / motion_duration_, 0.0, 1.0) : 1.0;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = (1 - fraction) * from_[i] + fraction * to_[i];
}

}  // namespace handsel::sim
