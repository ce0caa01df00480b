// SPDX-License-Identifier: Apache-2.0
// A person whose hand goes where a visitor of the page drags it. Own method: the hand that is free
// to leave what it does is guided; then it goes back, and the person continues.
#include <algorithm>

#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

void PersonModel::guide_hand(Side side, const Vector3& point, double duration) {
  if (followed_ || frozen_) return;
  const int s = side == Side::left ? 0 : 1;
  if (duration > 0 && !guided_[s]) {
    if (!may_guide(side)) return;
    guided_[s].emplace(points_[kHand[s]], hands_[s].velocity);
    if (leaves_handover_to_guide(side)) {
      side_ = side;
      hand_active_ = true;
      hand_target_ = points_[kHand[s]];
      lean_from_ = lean_;
      enter(PersonPhase::guided);
    }
  }
  if (guided_[s]) guided_[s]->guide(point, clock_ + duration);
}

void PersonModel::look_away(double duration) {
  settings_.behaviour.look_away_at = clock_;
  settings_.behaviour.look_away = duration;
}

/// Returns whether the hand can leave what it does: not while it exchanges an object, darts or
/// follows a recording.
bool PersonModel::may_guide(Side side) const {
  if (side != side_ && !uses_both_hands()) return true;
  switch (phase_) {
    case PersonPhase::closing:
    case PersonPhase::pulling:
    case PersonPhase::withdrawing:
    case PersonPhase::darting:
      return false;
    case PersonPhase::reaching:
      return !settings_.recording;
    case PersonPhase::leaving:
      return !wants_grip_;
    default:
      return !(wants_grip_ && held_by_robot_before_);
  }
}

/// Returns whether guiding this hand interrupts what the person does. Else only the arm moves
/// otherwise.
bool PersonModel::leaves_handover_to_guide(Side side) const {
  if (wants_grip_ && side != side_) return false;
  return phase_ == PersonPhase::watching || phase_ == PersonPhase::keeping ||
         phase_ == PersonPhase::offering ||
         (side == side_ && (phase_ == PersonPhase::reaching || phase_ == PersonPhase::retracting));
}

/// Returns the point nearest to `point` that the hand reaches, world [m].
Vector3 PersonModel::within_reach(int side, const Vector3& point) const {
  const PersonManners& manners = settings_.manners;
  const double min_reach = manners.guided_min_reach * reach_;
  const Vector3 arm = point - shoulder(side);
  const double distance = arm.norm();
  if (distance < 1e-6) return shoulder(side) + min_reach * forward();
  const double reached = std::clamp(distance, min_reach, manners.guided_max_reach * reach_);
  return shoulder(side) + reached / distance * arm;
}

void PersonModel::move_guided_hands(double dt) {
  for (int s = 0; s < 2; ++s) {
    if (!guided_[s]) continue;
    GuidedHand& hand = *guided_[s];
    const bool interrupts = phase_ == PersonPhase::guided && s == hand_index();
    const bool is_over = !hand.is_guided(clock_);
    const Vector3 usual = interrupts && wants_grip_ ? carry_position() : rest_position(s);
    const bool arrived =
        hand.step(dt, is_over ? usual : within_reach(s, hand.point()), settings_.manners);
    if (interrupts) hand_target_ = hand.position();
    if (!is_over || !arrived) continue;
    guided_[s].reset();
    if (interrupts) end_guide();
  }
  if (phase_ == PersonPhase::guided)
    lean_ = (1 - min_jerk(phase_time() / settings_.manners.guided_straighten_time)) * lean_from_;
}

/// Continues with what a person does with, or without, an object in the hand.
void PersonModel::end_guide() {
  from_ = hand_target_;
  hand_active_ = wants_grip_;
  raise_progress_ = 0;
  first_attempt_over_ = true;
  enter(wants_grip_ ? PersonPhase::keeping : PersonPhase::watching);
}

/// Bends the arms whose guided hand interrupts nothing.
void PersonModel::bend_guided_arms() {
  for (int s = 0; s < 2; ++s) {
    if (guided_[s] && !(phase_ == PersonPhase::guided && s == hand_index()))
      bend_arm(s, guided_[s]->position());
  }
}

}  // namespace handsel::sim
