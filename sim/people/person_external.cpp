// SPDX-License-Identifier: Apache-2.0
// A person whose body follows observations from outside; only the handover is simulated. Own
// method: a hand near an offered object is guided to the object. A hand whose reported position
// moves away while the robot holds the object pulls with limited force. A guided hand returns to
// its reported position.
#include <algorithm>

#include "common/model/object_surface.hpp"
#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {
namespace {

Vector3 limited(const Vector3& v, double max_norm) {
  return v.norm() > max_norm ? Vector3(max_norm / v.norm() * v) : v;
}

}  // namespace

void PersonModel::follow(const ObservedPerson& seen) {
  if (!followed_ || frozen_) return;
  if (followed_->observe(seen, clock_)) {  // placed without a motion: nothing is pushed or moved
                                           // along
    first_ = placed_ = true;
    wants_grip_ = hand_active_ = false;
    hand_offset_.setZero();
    enter(PersonPhase::watching);
  }
  if (seen.has_gaze) gaze_ = seen.gaze_direction;
}

void PersonModel::run_external_person(double dt, const PersonView& view) {
  place_body();
  const PersonManners& manners = settings_.manners;
  const auto is_offered_to_hand = [&](int side) {
    return cooldown_ <= 0 && is_offered_to(view, side);
  };
  const bool wanted = is_offered_to_hand(hand_index());
  const auto in_reach = [&](int side) {
    const Vector3& hand = points_[kHand[side]];
    return (nearest_grasp_point(view, hand) - hand).norm() <= settings_.correction + kPalmDistance;
  };
  cooldown_ = std::max(0.0, cooldown_ - dt);
  const auto p_reported = [&](int side) { return points_[kHand[side]]; };
  switch (phase_) {
    case PersonPhase::reaching:
    case PersonPhase::closing: {
      Vector3 to = p_reported(hand_index());
      if (wanted && in_reach(hand_index())) to = nearest_grasp_point(view, to);
      hand_offset_ +=
          limited(to - p_reported(hand_index()) - hand_offset_, manners.external_guide_speed * dt);
      if (!wanted && hand_offset_.norm() < 1e-9) {
        hand_active_ = false;
        enter(PersonPhase::watching);
        return;
      }
      hand_target_ = p_reported(hand_index()) + hand_offset_;
      const bool touches =
          wanted && hand_to_surface(view) < kPalmDistance + manners.taking_touch_gap;
      if (touches != (phase_ == PersonPhase::closing))
        enter(touches ? PersonPhase::closing : PersonPhase::reaching);
      if (phase_ != PersonPhase::closing || phase_time() < manners.person_close_time) return;
      wants_grip_ = true;
      enter(PersonPhase::pulling);
      return;
    }
    case PersonPhase::pulling:
      pull_toward(p_reported(hand_index()) + hand_offset_, dt, view);
      return;
    case PersonPhase::withdrawing:
    case PersonPhase::keeping:
      if (!wants_grip_ || view.grip_broke) return release();
      hand_offset_ -=
          limited(hand_offset_, manners.external_guide_speed *
                                    min_jerk(phase_time() / manners.external_return_rise) * dt);
      hand_target_ = p_reported(hand_index()) + hand_offset_;
      if (phase_ == PersonPhase::withdrawing &&
          hand_offset_.norm() < manners.external_return_distance)
        enter(PersonPhase::keeping);
      return;
    default:
      offer_time_ = is_offered_to_hand(0) || is_offered_to_hand(1) ? offer_time_ + dt : 0;
      for (int s = 0; s < 2; ++s) {
        if (offer_time_ < settings_.reaction || !is_offered_to_hand(s) || !in_reach(s)) continue;
        side_ = s == 0 ? Side::left : Side::right;
        hand_offset_.setZero();
        hand_target_ = p_reported(s);
        hand_active_ = true;
        enter(PersonPhase::reaching);
        return;
      }
  }
}

/// Holds the object while the robot holds it, and pulls toward the position of the free hand.
void PersonModel::pull_toward(const Vector3& p_free_hand, double dt, const PersonView& view) {
  if (!wants_grip_ || view.grip_broke || view.object == nullptr) return release();
  const PersonManners& manners = settings_.manners;
  const Vector3 to_free_hand = p_free_hand - hand_target_;
  const Vector3 direction = to_free_hand.stableNormalized();
  const double wanted =
      std::min(settings_.pull, manners.external_pull_stiffness * to_free_hand.norm());
  const double speed =
      std::clamp(manners.taking_pull_admittance * (wanted - view.grip_force.dot(direction)),
                 -manners.taking_max_pull_speed, manners.taking_max_pull_speed);
  hand_target_ += speed * dt * direction;
  overload_time_ =
      view.grip_force.norm() > manners.person_max_tolerated_force ? overload_time_ + dt : 0;
  exit_time_ = view.held_by_robot ? 0 : exit_time_ + dt;
  if (overload_time_ > manners.taking_overload_time ||
      to_free_hand.norm() > manners.external_max_pull_distance)
    return release();
  if (exit_time_ <= manners.taking_free_time) return;
  hand_offset_ += hand_target_ - p_free_hand;
  enter(PersonPhase::withdrawing);
}

void PersonModel::release() {
  wants_grip_ = false;
  cooldown_ = settings_.manners.external_cooldown;
  hand_offset_ = hand_target_ - points_[kHand[hand_index()]];
  enter(PersonPhase::reaching);
}

}  // namespace handsel::sim
