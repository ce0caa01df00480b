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

constexpr double kMaxGuideSpeed = 0.6;    // max speed of guiding the hand [m/s]
constexpr double kMaxTouchGap = 0.012;    // max distance of palm and surface at which it closes [m]
constexpr double kPullStiffness = 200.0;  // pull force per distance to the reported hand [N/m]
constexpr double kMaxPullSpeed = 0.1;     // max speed of the hand while it pulls [m/s]
// Max distance of the reported hand from the held hand before the person releases the object [m].
constexpr double kMaxPullDistance = 0.5;
constexpr double kAdmittance = 0.02;  // speed of the hand per force error [m/s/N]
// Max distance from the reported position at which a guided hand counts as returned [m].
constexpr double kReturnedDistance = 0.02;

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
      hand_offset_ += limited(to - p_reported(hand_index()) - hand_offset_, kMaxGuideSpeed * dt);
      if (!wanted && hand_offset_.norm() < 1e-9) {
        hand_active_ = false;
        enter(PersonPhase::watching);
        return;
      }
      hand_target_ = p_reported(hand_index()) + hand_offset_;
      const bool touches = wanted && hand_to_surface(view) < kPalmDistance + kMaxTouchGap;
      if (touches != (phase_ == PersonPhase::closing))
        enter(touches ? PersonPhase::closing : PersonPhase::reaching);
      if (phase_ != PersonPhase::closing || phase_time() < kCloseTime) return;
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
      hand_offset_ -= limited(hand_offset_, kMaxGuideSpeed * min_jerk(phase_time() / 0.5) * dt);
      hand_target_ = p_reported(hand_index()) + hand_offset_;
      if (phase_ == PersonPhase::withdrawing && hand_offset_.norm() < kReturnedDistance)
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
  const Vector3 to_free_hand = p_free_hand - hand_target_;
  const Vector3 direction = to_free_hand.stableNormalized();
  const double wanted = std::min(settings_.pull, kPullStiffness * to_free_hand.norm());
  const double speed = std::clamp(kAdmittance * (wanted - view.grip_force.dot(direction)),
                                  -kMaxPullSpeed, kMaxPullSpeed);
  hand_target_ += speed * dt * direction;
  overload_time_ = view.grip_force.norm() > kMaxToleratedForce ? overload_time_ + dt : 0;
  exit_time_ = view.held_by_robot ? 0 : exit_time_ + dt;
  if (overload_time_ > 0.1 || to_free_hand.norm() > kMaxPullDistance) return release();
  if (exit_time_ <= 0.1) return;
  hand_offset_ += hand_target_ - p_free_hand;
  enter(PersonPhase::withdrawing);
}

void PersonModel::release() {
  wants_grip_ = false;
  cooldown_ = 1.0;
  hand_offset_ = hand_target_ - points_[kHand[hand_index()]];
  enter(PersonPhase::reaching);
}

}  // namespace handsel::sim
