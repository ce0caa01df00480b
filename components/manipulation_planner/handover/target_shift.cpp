// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/target_shift.hpp"

namespace handsel::manipulation_planner {

void TargetShift::advise(const AttentionAdvice& advice, TimePoint now) {
  shift_.advise(advice.has_target_shift ? std::optional(advice.target_shift) : std::nullopt, now);
}

void TargetShift::note_choice(const Vector3& p_chosen, TimePoint now) {
  p_chosen_ = p_chosen;
  p_shifted_.reset();
  p_refused_.reset();
  changed_at_ = now;
}

bool TargetShift::has_led_to(const Vector3& p) const {
  return p_shifted_ && (p - *p_shifted_).norm() < reached_;
}

std::optional<Vector3> TargetShift::wanted(const Vector3& p_present, TimePoint now) const {
  return p_chosen_ ? wanted_around(*p_chosen_, p_present, now) : std::nullopt;
}

std::optional<Vector3> TargetShift::wanted_around(const Vector3& p_center, const Vector3& p_present,
                                                  TimePoint now) const {
  const std::optional<std::optional<Vector3>> advised = shift_.at(now);
  if (!advised || !*advised || max_shift_ <= 0 || now - changed_at_ < pause_) return std::nullopt;
  Vector3 from_center = p_present + **advised - p_center;
  if (from_center.norm() > max_shift_) from_center *= max_shift_ / from_center.norm();
  const Vector3 p_wanted = p_center + from_center;
  if ((p_wanted - p_present).norm() < min_shift_) return std::nullopt;
  if (p_refused_ && (p_wanted - *p_refused_).norm() < min_shift_) return std::nullopt;
  return p_wanted;
}

}  // namespace handsel::manipulation_planner
