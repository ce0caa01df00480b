// SPDX-License-Identifier: Apache-2.0
// What a person does with a fetched object: puts it down elsewhere, or walks away with it.
#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

/// Ends the time for which a fetcher keeps the object in the hand.
void PersonModel::end_keeping(const PersonView& view) {
  if (phase_time() <= settings_.manners.fetcher_keep_time) return;
  if (settings_.puts_at)
    begin_to_put(view);
  else
    leave();
}

/// Walks backward; a held object stays in the hand.
void PersonModel::walk_away() {
  const PersonManners& manners = settings_.manners;
  const double length = manners.person_leave_distance;
  feet_ = home_ - length * min_jerk(phase_time() * manners.person_walk_speed / length) * forward();
  if (wants_grip_) hand_target_ = carry_position();
}

/// Begins the motion of the hand that brings the held object to where it is put down.
void PersonModel::begin_to_put(const PersonView& view) {
  if (view.object == nullptr) return give_up();
  const PersonManners& manners = settings_.manners;
  from_ = hand_target_;
  to_ = *settings_.puts_at + (hand_target_ - view.T_world_object.translation());
  lean_from_ = lean_;
  lean_to_ = lean_to_reach(to_);
  duration_ = std::clamp(
      manners.taking_reach_time + manners.taking_time_per_distance * (to_ - from_).norm(),
      manners.taking_min_reach_time, manners.taking_max_reach_time);
  enter(PersonPhase::putting);
}

/// Moves the held object over the place, lowers it, and lets go.
void PersonModel::put_down() {
  const PersonManners& manners = settings_.manners;
  if (!wants_grip_) return give_up();
  const double over = min_jerk(phase_time() / duration_);
  const double lowered = min_jerk((phase_time() - duration_) / manners.putting_lower_time);
  lean_ = lean_from_ + over * (lean_to_ - lean_from_);
  if (!settings_.behaviour.seated)
    feet_ = home_ - (1 - over) * manners.taking_step_back * forward();
  hand_target_ = from_ + over * (to_ - from_) +
                 over * (1 - lowered) * manners.putting_clearance * Vector3::UnitZ();
  if (lowered < 1) return;
  refusing_ = true;  // the object stays there
  give_up();
}

}  // namespace handsel::sim
