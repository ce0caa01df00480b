// A person moved from outside: the body goes where it is told; only the exchange is its own (ours).
// What is offered near a hand draws the hand onto it, as somebody who sees it would; a hand that is
// told to go away while the robot still holds on pulls, with limited force; a hand that was led
// comes back to where it is told to be.
#include <algorithm>

#include "common/model/object_surface.hpp"
#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {
namespace {

constexpr double kLead = 0.6;         // the hand is led no faster than this [m/s]
constexpr double kTouch = 0.012;      // as near as this to the surface it closes [m]
constexpr double kClose = 0.25;       // [s]
constexpr double kStretch = 200.0;    // pull by how far the told hand has gone away [N/m]
constexpr double kPullSpeed = 0.1;    // [m/s]
constexpr double kGivesUp = 0.5;      // away from what it holds while the robot holds on [m]
constexpr double kAdmittance = 0.02;  // [m/s/N]
constexpr double kBack = 0.02;        // a hand this near to where it is told to be is back [m]

Vector3 limited(const Vector3& v, double longest) {
  return v.norm() > longest ? Vector3(longest / v.norm() * v) : v;
}

}  // namespace

void PersonModel::follow(const ObservedPerson& seen) {
  if (!followed_ || frozen_) return;
  if (followed_->observe(seen, clock_)) {  // it is there from one moment to the next: nothing is
                                           // moved, pushed or taken along
    first_ = placed_ = true;
    wants_grip_ = hand_active_ = false;
    led_.setZero();
    enter(PersonPhase::watching);
  }
  if (seen.has_gaze) gaze_ = seen.gaze_direction;
}

void PersonModel::accompany(double dt, const PersonView& view) {
  place_base();
  const auto wanted_by = [&](int side) { return cooldown_ <= 0 && offered(view, side); };
  const bool wanted = wanted_by(index());
  const auto in_reach = [&](int side) {
    const Vector3& hand = points_[kHand[side]];
    return (nearest_hold(view, hand) - hand).norm() <= settings_.correction + kPalm;
  };
  cooldown_ = std::max(0.0, cooldown_ - dt);
  const auto told = [&](int side) { return points_[kHand[side]]; };
  switch (phase_) {
    case PersonPhase::reaching:
    case PersonPhase::closing: {
      Vector3 to = told(index());
      if (wanted && in_reach(index())) to = nearest_hold(view, to);
      led_ += limited(to - told(index()) - led_, kLead * dt);
      if (!wanted && led_.norm() < 1e-9) {
        hand_active_ = false;
        enter(PersonPhase::watching);
        return;
      }
      hand_target_ = told(index()) + led_;
      const bool touches = wanted && gap(view) < kPalm + kTouch;
      if (touches != (phase_ == PersonPhase::closing))
        enter(touches ? PersonPhase::closing : PersonPhase::reaching);
      if (phase_ != PersonPhase::closing || since() < kClose) return;
      wants_grip_ = true;
      enter(PersonPhase::pulling);
      return;
    }
    case PersonPhase::pulling:
      pull_after(told(index()) + led_, dt, view);
      return;
    case PersonPhase::withdrawing:
    case PersonPhase::keeping:
      if (!wants_grip_ || view.grip_broke) return release();
      led_ -= limited(led_, kLead * min_jerk(since() / 0.5) * dt);
      hand_target_ = told(index()) + led_;
      if (phase_ == PersonPhase::withdrawing && led_.norm() < kBack) enter(PersonPhase::keeping);
      return;
    default:
      offer_time_ = wanted_by(0) || wanted_by(1) ? offer_time_ + dt : 0;
      for (int s = 0; s < 2; ++s) {
        if (offer_time_ < settings_.reaction || !wanted_by(s) || !in_reach(s)) continue;
        side_ = s == 0 ? Side::left : Side::right;
        led_.setZero();
        hand_target_ = told(s);
        hand_active_ = true;
        enter(PersonPhase::reaching);
        return;
      }
  }
}

/// Holds on while the robot does, and pulls toward where the hand would be.
void PersonModel::pull_after(const Vector3& would_be, double dt, const PersonView& view) {
  if (!wants_grip_ || view.grip_broke || view.object == nullptr) return release();
  const Vector3 away = would_be - hand_target_;
  const Vector3 direction = away.stableNormalized();
  const double wanted = std::min(settings_.pull, kStretch * away.norm());
  const double speed =
      std::clamp(kAdmittance * (wanted - view.grip_force.dot(direction)), -kPullSpeed, kPullSpeed);
  hand_target_ += speed * dt * direction;
  sore_time_ = view.grip_force.norm() > kSoreForce ? sore_time_ + dt : 0;
  lost_time_ = view.held_by_robot ? 0 : lost_time_ + dt;
  if (sore_time_ > 0.1 || away.norm() > kGivesUp) return release();
  if (lost_time_ <= 0.1) return;
  led_ += hand_target_ - would_be;
  enter(PersonPhase::withdrawing);
}

void PersonModel::release() {
  wants_grip_ = false;
  cooldown_ = 1.0;
  led_ = hand_target_ - points_[kHand[index()]];
  enter(PersonPhase::reaching);
}

}  // namespace handsel::sim
