// SPDX-License-Identifier: Apache-2.0
// Individual behaviour of people: offers, hesitation, withdrawal, averted gaze, sidesteps.
#include <limits>

#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

/// Returns the completed fraction of a reach or an offer, 0 to 1.
double PersonModel::reach_fraction() const {
  const double t = phase_time(), part = settings_.manners.person_part_time * duration_,
               stop = settings_.behaviour.hesitation, midway = settings_.manners.person_midway;
  const bool in_two_parts = !first_attempt_over_ && (stop > 0 || settings_.behaviour.withdraws);
  if (!in_two_parts) return min_jerk(t / duration_);
  return t < part + stop ? midway * min_jerk(t / part)
                         : midway + (1 - midway) * min_jerk((t - part - stop) / part);
}

double PersonModel::reach_duration() const {
  const bool in_two_parts =
      !first_attempt_over_ && (settings_.behaviour.hesitation > 0 || settings_.behaviour.withdraws);
  return in_two_parts
             ? 2 * settings_.manners.person_part_time * duration_ + settings_.behaviour.hesitation
             : duration_;
}

bool PersonModel::is_offering() const {
  return phase_ == PersonPhase::offering && phase_time() >= reach_duration();
}

/// Returns whether the person is to offer: a giver always, a partner once the robot has asked for
/// at least the reaction time.
bool PersonModel::is_to_offer() const {
  if (refusing_) return false;
  return settings_.kind == PersonKind::giver ||
         (announcement_ == Announcement::asks && clock_ - announced_at_ >= settings_.reaction);
}

void PersonModel::hold_object(const PersonView& view) {
  const double back = settings_.manners.giving_time / settings_.behaviour.speed_scale;
  hand_target_ = from_ + min_jerk(phase_time() / back) * (carry_position() - from_);
  if (!is_to_offer() || phase_time() < duration_) return;
  from_ = hand_target_;
  home_ = feet_;
  duration_ = back;
  hold_to_give_back(view);
  p_shoulder_offer_ = offer_from_shoulder(view);
  enter(PersonPhase::offering);
}

/// Returns the step that returns a partner to the starting place after the step back with a
/// received object; zero for all others.
Vector3 PersonModel::step_to_place() const {
  return settings_.kind == PersonKind::partner ? Vector3(settings_.feet - home_)
                                               : Vector3(Vector3::Zero());
}

/// Returns the vector from the shoulder to a comfortable offer toward the robot's hand, at least
/// giving_min_hand_distance from the hand, after a step; world [m].
Vector3 PersonModel::offer_from_shoulder(const PersonView& view, const Vector3& step) const {
  const PersonManners& manners = settings_.manners;
  const Vector3 root = shoulder(hand_index()),
                to_hand = view.robot_hand - root - (home_ + step_to_place() - feet_) - step;
  if (uses_both_hands()) {
    // The middle between the hands is straight ahead.
    const Vector3 middle = middle_of_reach() - root;
    const double shortfall = manners.giving_min_hand_distance - (to_hand - middle).norm();
    return middle - std::max(0.0, shortfall) * forward() - second_hand_.offset() / 2;
  }
  Vector3 arm = comfortable_reach(body_, side_) - root;
  const double turn =
      std::remainder(std::atan2(to_hand.y(), to_hand.x()) - std::atan2(arm.y(), arm.x()), 2 * M_PI);
  arm = Eigen::AngleAxisd(std::clamp(turn, -manners.giving_max_turn, manners.giving_max_turn),
                          Vector3::UnitZ()) *
        arm;
  const double shortfall = manners.giving_min_hand_distance - (to_hand - arm).norm();
  if (shortfall > 0) arm.head<2>() *= std::max(0.0, 1 - shortfall / arm.head<2>().norm());
  // An object beside the hand is offered as far from the body as an object in front of the hand,
  // and straight ahead.
  const Vector3 held = facing() * p_hand_object_to_give_.value_or(view.p_hand_object);
  if (taking_.has_place())
    arm += std::max(0.0, manners.giving_object_ahead - held.dot(forward())) * forward() -
           held.dot(left()) * left();
  return arm;
}

void PersonModel::return_to_place() {
  const Vector3 step = step_to_place();
  if (step.norm() > 0)
    feet_ = home_ + min_jerk(phase_time() / step_time(step.norm(), settings_.manners)) * step;
}

/// Turns a giver into a partner, who receives the object back and offers it at rest on request.
void PersonModel::become_partner() {
  if (settings_.kind == PersonKind::giver) settings_.kind = PersonKind::partner;
  settings_.moving = {};
}

void PersonModel::offer(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  // Fingers that only touch the object cannot bear its weight.
  exit_time_ = view.held_firmly ? exit_time_ + dt : 0;
  if (exit_time_ > manners.giving_release_delay) {
    become_partner();
    return give_up();
  }
  if (view.held_by_robot) return;
  if (settings_.moving.duration > 0) {
    offer_in_motion(dt, view);
    if (!moving_->is_over()) return;
  } else {
    return_to_place();
    turn_hand_back(dt);
    hand_target_ = from_ + reach_fraction() * (shoulder(hand_index()) + p_shoulder_offer_ - from_);
  }
  const bool is_hand_near =
      view.object != nullptr &&
      (view.robot_hand - object_centre(view)).norm() < manners.giving_withdraw_distance;
  if (is_hand_near || phase_time() < duration_) ignored_time_ = 0;
  if ((ignored_time_ += dt) > manners.giving_max_ignored_time) return repeat_offer(view);
  if (is_to_offer() && !(is_hand_near && settings_.behaviour.withdraws && !first_attempt_over_))
    return;
  first_attempt_over_ = true;
  if (!is_to_offer()) remember_hold();
  from_ = hand_target_;
  duration_ = manners.giving_second_offer_delay;
  enter(PersonPhase::keeping);
}

/// Repeats an ignored offer: by another hold and nearer to the robot's hand. Draws the object back
/// first if the robot's hand leaves no room to hold the object anew.
void PersonModel::repeat_offer(const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  ignored_time_ = 0;
  settings_.moving = {};
  from_ = hand_target_;
  home_ = feet_;
  if (gives_from_place() && !is_robot_hand_far(view)) {
    remember_hold();
    duration_ = manners.giving_second_offer_delay;
    return enter(PersonPhase::keeping);
  }
  hold_otherwise(view);
  const Vector3 step =
      manners.giving_step_nearer *
      (view.robot_hand - points_[kTorso]).cwiseProduct(Vector3(1, 1, 0)).stableNormalized();
  p_shoulder_offer_ = offer_from_shoulder(view);
  const Vector3 nearer = offer_from_shoulder(view, step);
  // A step that only bends the arm is not made.
  const bool has_room = nearer.norm() > p_shoulder_offer_.norm() - manners.giving_max_shortening;
  const bool steps_nearer =
      has_room && !settings_.behaviour.seated && steps_nearer_ < manners.giving_max_steps_nearer;
  if (steps_nearer) p_shoulder_offer_ = nearer;
  if (steps_nearer) {
    ++steps_nearer_;
    settings_.behaviour.sidestep = step;
    home_aside_ = aside_;
    sidestep_time_ = 0;
    settings_.behaviour.sidestep_at = behaviour_time();
  }
  enter(PersonPhase::offering);
}

/// Turns the hand back to the neutral configuration of the wrist.
void PersonModel::turn_hand_back(double dt) {
  if (hand_turn_.w() < 1)
    hand_turn_ = hand_turn_.slerp(std::min(1.0, dt / settings_.manners.moving_return_time),
                                  Eigen::Quaterniond::Identity());
}

/// Moves the hand to the start of the moving offer, then along its curves. The object turns about
/// its own origin, so the hand moves around the object.
void PersonModel::offer_in_motion(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  if (!moving_) {
    const ArmReach reach{shoulder(hand_index()),
                         forward(),
                         manners.moving_min_extension * reach_,
                         manners.moving_max_extension * reach_,
                         manners.moving_min_ahead,
                         view.robot_hand - facing() * view.p_hand_object,
                         manners.moving_min_palm_distance};
    // The boxes bound the object, but the reach bounds the hand in the neutral wrist configuration.
    MovingOfferSettings of_hand = settings_.moving;
    p_hand_object_ = view.p_hand_object;
    const Vector3 ahead = facing() * p_hand_object_;
    for (Vector3* corner :
         {&of_hand.start_low, &of_hand.start_high, &of_hand.next_low, &of_hand.next_high})
      *corner -= ahead;
    moving_.emplace(of_hand, reach, shoulder(hand_index()) + p_shoulder_offer_);
  }
  const bool waits = view.finger_distance < settings_.moving.waits_within;
  if (waits && phase_time() < manners.moving_start_time) phase_since_ += dt;
  const double s = min_jerk(phase_time() / manners.moving_start_time);
  if (s >= 1) moving_->step(dt, waits);
  hand_turn_ = Eigen::Quaterniond::Identity().slerp(s, moving_->turn());
  const Vector3 turned = facing() * (p_hand_object_ - hand_turn_ * p_hand_object_);
  hand_target_ = from_ + s * (moving_->position() + turned - from_);
}

/// Returns the time to which sidestep and change of hand refer [s].
double PersonModel::behaviour_time() const {
  return settings_.behaviour.from_carry ? clock_ - carried_since_ : clock_;
}

bool PersonModel::has_changed_hands() const {
  return behaviour_time() >= settings_.behaviour.changes_hand_at;
}

Side PersonModel::preferred_side() const {
  const Side usual = settings_.left_handed ? Side::left : Side::right;
  return has_changed_hands() ? other_side(usual) : usual;
}

/// Raises the preferred hand in front of the body while the robot holds the object. Uses the other
/// hand if only that hand reaches the object and is free. Lowers a raised hand before a change.
void PersonModel::raise_hand_in_advance(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  Side wanted = preferred_side();
  const bool robot_holds_object = view.object != nullptr && view.held_by_robot;
  if (robot_holds_object && !has_changed_hands() &&
      !is_offered_to(view, wanted == Side::left ? 0 : 1) &&
      is_offered_to(view, wanted == Side::left ? 1 : 0))
    wanted = other_side(wanted);
  const bool is_raised = robot_holds_object && side_ == wanted && !refusing_;
  raise_progress_ =
      std::clamp(raise_progress_ + (is_raised ? dt : -dt) / manners.person_raise_time, 0.0, 1.0);
  hand_active_ = raise_progress_ > 0;
  if (!hand_active_) side_ = wanted;
  const Vector3 rest = rest_position();
  const Vector3 raised =
      shoulder(hand_index()) + settings_.stature * (manners.person_raised_ahead * forward() -
                                                    Vector3(0, 0, manners.person_raised_below));
  hand_target_ = rest + min_jerk(raise_progress_) * (raised - rest);
}

/// Moves the body aside, except while the robot's hand presses on the object that the person
/// offers, or a hand reaches.
void PersonModel::step_aside(double dt, const PersonView& view) {
  const double length = settings_.behaviour.sidestep.norm();
  if (length <= 0) return;
  const bool free = phase_ == PersonPhase::watching || phase_ == PersonPhase::keeping ||
                    (phase_ == PersonPhase::offering && !view.pressed_by_robot && exit_time_ <= 0);
  const double duration = step_time(length, settings_.manners);
  const bool under_way = sidestep_time_ > 0 && sidestep_time_ < duration;
  if (behaviour_time() < settings_.behaviour.sidestep_at || !(free || under_way)) return;
  sidestep_time_ += dt;
  aside_ = home_aside_ + min_jerk(sidestep_time_ / duration) * settings_.behaviour.sidestep;
}

/// Returns the min height of a holding hand at this position, world [m]. A hand is lifted over
/// furniture lower than the shoulder only: a tall shelf is passed at its side.
double PersonModel::height_above_furniture(const Vector3& hand) const {
  const PersonManners& manners = settings_.manners;
  double min_height = -std::numeric_limits<double>::infinity();
  const double shoulder_height = shoulder(hand_index()).z();
  for (const Furniture& box : settings_.furniture) {
    const Vector3 p = box.T_world_box.inverse() * hand, half = box.size / 2;
    const double up = (box.T_world_box.linear().row(2).transpose().cwiseAbs()).dot(half),
                 z = box.T_world_box.translation().z();
    if (hand.z() < z - up || z + up > shoulder_height) continue;
    const double beside = (p.cwiseAbs() - half).cwiseMax(0).head<2>().norm();
    const double above = std::max(manners.person_above_furniture,
                                  held_below_ + manners.person_object_above_furniture);
    min_height = std::max(min_height,
                          z + up + above - std::max(0.0, beside - manners.person_beside_furniture));
  }
  return min_height;
}

/// Raises the hand above furniture if only this person holds the object.
void PersonModel::keep_above_furniture(const Vector3& robot_hand) {
  const bool holds_alone = phase_ == PersonPhase::withdrawing || phase_ == PersonPhase::keeping ||
                           phase_ == PersonPhase::leaving ||
                           (phase_ == PersonPhase::offering && exit_time_ <= 0);
  if (!holds_alone) return;
  // A received object is moved away from the robot's hand before it is lifted over furniture.
  const PersonManners& manners = settings_.manners;
  const double away = ((hand_target_ - robot_hand).norm() - manners.person_lift_min_distance) /
                      manners.person_lift_range;
  const double lift_fraction =
      phase_ == PersonPhase::withdrawing
          ? std::min(min_jerk(phase_time() / manners.person_lift_time), min_jerk(away))
          : 1.0;
  const double min_height = height_above_furniture(hand_target_);
  hand_target_.z() += lift_fraction * std::max(0.0, min_height - hand_target_.z());
  // A held object is not pressed down on furniture.
  if (phase_ == PersonPhase::withdrawing)
    hand_target_.z() =
        std::max(hand_target_.z(), std::min(min_height, before_[kHand[hand_index()]].z()));
}

/// Returns how far the object extends below the hand [m].
double PersonModel::extent_below_hand(const PersonView& view) const {
  if (view.object == nullptr) return 0;
  double lowest = hand_target_.z();
  for (const Vector3& p : view.object->mesh.vertices)
    lowest = std::min(lowest, (view.T_world_object * p).z());
  return hand_target_.z() - lowest;
}

Vector3 PersonModel::gaze_target(const PersonView& view) const {
  if (refusing_ || phase_ == PersonPhase::leaving || settings_.kind == PersonKind::walker)
    return points_[kHead] + forward();
  const BehaviourProfile& behaviour = settings_.behaviour;
  if (clock_ >= behaviour.look_away_at && clock_ < behaviour.look_away_at + behaviour.look_away)
    return points_[kHead] + left() + 0.3 * forward();
  const bool is_object_relevant = view.object != nullptr && (view.held_by_robot || wants_grip_ ||
                                                             settings_.kind == PersonKind::fetcher);
  return is_object_relevant ? object_centre(view) : view.robot_hand;
}

}  // namespace handsel::sim
