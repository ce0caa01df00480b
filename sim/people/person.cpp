// SPDX-License-Identifier: Apache-2.0
#include "sim/people/person.hpp"

#include <algorithm>

#include "sim/people/person_parts.hpp"

namespace handsel::sim {

const char* name(PersonPhase phase) {
  static constexpr const char* kNames[] = {
      "arriving",   "watching", "reaching", "closing", "pulling", "withdrawing", "keeping",
      "retracting", "offering", "darting",  "leaving", "guided",  "putting"};
  return kNames[static_cast<int>(phase)];
}

PersonModel::PersonModel(const PersonSettings& settings)
    : settings_(settings), feet_(settings.feet), home_(settings.feet), yaw_(settings.yaw) {
  const std::vector<BodyJoint> rest = settings_.behaviour.seated
                                          ? sitting_body(Vector3::Zero(), 0, settings_.stature)
                                          : standing_body(Vector3::Zero(), 0, settings_.stature);
  for (std::size_t i = 0; i < template_.size(); ++i) template_[i] = rest[i].position;
  side_ = settings_.left_handed ? Side::left : Side::right;
  if (settings_.recording) {
    side_ = settings_.recording->taking;
    template_ = settings_.recording->frames.front();
  }
  const int s = hand_index();
  reach_ = (template_[kElbow[s]] - template_[kShoulder[s]]).norm() +
           (template_[kWrist[s]] - template_[kElbow[s]]).norm() +
           (template_[kHand[s]] - template_[kWrist[s]]).norm();
  gaze_ = forward();
  body_.id = settings_.id;
  body_.stature = settings_.stature;
  body_.gaze_known = true;
  body_.joints.resize(kBodyJoints.size());
  for (std::size_t i = 0; i < kBodyJoints.size(); ++i) body_.joints[i].name = kBodyJoints[i];
  if (settings_.kind == PersonKind::walker || settings_.approach_from > 0) {
    feet_ = home_ - settings_.approach_from * forward();
    phase_ = PersonPhase::arriving;
  }
  if (settings_.kind == PersonKind::giver || settings_.holds) {
    phase_ = PersonPhase::keeping;
    hand_active_ = wants_grip_ = true;
    place_body();
    hand_target_ = from_ = carry_position();
    duration_ = settings_.reaction;
  }
  if (settings_.kind == PersonKind::external) {
    place_body();
    followed_.emplace(points_, settings_.stature, settings_.manners);
  }
  step(0, PersonView{});
}

bool PersonModel::in_handover() const {
  if (settings_.kind == PersonKind::fetcher) return false;
  switch (phase_) {
    case PersonPhase::reaching:
    case PersonPhase::closing:
    case PersonPhase::pulling:
    case PersonPhase::withdrawing:
    case PersonPhase::retracting:
    case PersonPhase::offering:
      return true;
    default:
      return false;
  }
}

void PersonModel::enter(PersonPhase phase) {
  phase_ = phase;
  phase_since_ = clock_;
  exit_time_ = overload_time_ = progress_ = 0;
}

void PersonModel::dart(double speed) {
  speed_ = speed;
  feet_speed_ = 0;
  hand_active_ = true;
  hand_target_ = hand_point();
  enter(PersonPhase::darting);
}

void PersonModel::announce(Announcement announcement) {
  if (announcement == announcement_) return;
  announcement_ = announcement;
  announced_at_ = clock_;
}

void PersonModel::leave() {
  home_ = feet_;
  enter(PersonPhase::leaving);
}

void PersonModel::step(double dt, const PersonView& view) {
  if (!frozen_ && dt > 0) {
    clock_ += dt;
    if (view.held_by_robot) carried_since_ = std::min(carried_since_, clock_);
    if (!view.held_by_robot)
      p_object_at_grasp_.reset();
    else if (!held_by_robot_before_ && !wants_grip_)
      p_object_at_grasp_ = view.T_world_object.translation();
    held_by_robot_before_ = view.held_by_robot;
    if (settings_.kind == PersonKind::external) {
      run_external_person(dt, view);
    } else if (phase_ == PersonPhase::guided) {
      if (view.grip_broke) wants_grip_ = false;
    } else if (settings_.kind != PersonKind::still) {
      run_phase(dt, view);
    }
    move_guided_hands(dt);
    if (settings_.steps_in.speed > 0)
      feet_ = home_ - distance_from_place(settings_.steps_in, settings_.approach_from, clock_,
                                          settings_.manners.person_max_step_acceleration) *
                          forward();
    step_aside(dt, view);
    update_hand(dt, view);
    if (!followed_) turn_gaze(gaze_target(view), dt);
  }
  placed_ = false;
  place_body();
  if (wants_grip_) keep_above_furniture(view.robot_hand);
  if (hand_active_) {
    bend_arm(hand_index(), hand_target_);
    hand_target_ = points_[kHand[hand_index()]];
  }
  if (!frozen_ && dt > 0) move_second_hand();
  if (second_hand_.is_active()) bend_arm(1 - hand_index(), second_hand_.target());
  bend_guided_arms();
  command_hands(dt);
  for (int s = 0; s < 2; ++s) {
    if (!view.hand_pushed[s].isZero(0)) bend_arm(s, points_[kHand[s]] + view.hand_pushed[s]);
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    body_.joints[i].position = points_[i];
    body_.joints[i].velocity =
        first_ || dt <= 0 ? Vector3(Vector3::Zero()) : Vector3((points_[i] - before_[i]) / dt);
  }
  before_ = points_;
  first_ = false;
  body_.gaze_direction = gaze_;
  body_.gaze_origin = points_[kHead] + 0.08 * gaze_;
  body_.palms.clear();
  for (const int s : {hand_index(), 1 - hand_index()}) {
    if (const auto& hand = hand_configuration(s))
      body_.palms.push_back(
          {kBodyJoints[static_cast<std::size_t>(kHand[s])], hand->R_world_hand * Vector3::UnitX()});
  }
}

bool PersonModel::waits_for_robot(const PersonView& view) const {
  if (settings_.kind != PersonKind::walker || !view.platform) return false;
  const PersonManners& manners = settings_.manners;
  const Vector3 walk = walk_direction_ * forward();
  const auto is_ahead = [&](const Vector3& p_world, double beside) {
    const Vector3 to = (p_world - feet_).cwiseProduct(Vector3(1, 1, 0));
    const double ahead = to.dot(walk);
    return ahead > 0 && ahead < manners.walker_robot_ahead && (to - ahead * walk).norm() < beside;
  };
  return is_ahead(*view.platform, manners.walker_robot_beside) ||
         is_ahead(view.robot_hand, manners.walker_hand_beside);
}

void PersonModel::wait_for_robot(double dt, double duration) {
  phase_since_ += dt;
  waited_for_robot_ += dt;
  if (waited_for_robot_ < settings_.manners.walker_max_wait) return;
  waited_for_robot_ = 0;
  walk_direction_ = -walk_direction_;
  phase_since_ += 2 * phase_time() - duration;  // same place on the walk back
}

void PersonModel::run_phase(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  if (wants_grip_ && view.grip_broke) give_up();
  switch (phase_) {
    case PersonPhase::arriving: {
      const double length =
          settings_.approach_from * (settings_.kind == PersonKind::walker ? 2 : 1);
      if (waits_for_robot(view))
        wait_for_robot(dt, length / manners.person_walk_speed);
      else
        waited_for_robot_ = 0;
      const double s = length > 0 ? phase_time() * manners.person_walk_speed / length : 1;
      feet_ =
          home_ + (length * min_jerk(s) - settings_.approach_from) * walk_direction_ * forward();
      if (s < 1) break;
      if (settings_.kind == PersonKind::walker) {
        walk_direction_ = -walk_direction_;
        enter(PersonPhase::arriving);
      } else {
        enter(PersonPhase::watching);
      }
      break;
    }
    case PersonPhase::watching:
      watch(dt, view);
      break;
    case PersonPhase::reaching:
      if (settings_.recording) {
        replay(dt, view);
      } else {
        reach_out(dt, view);
      }
      break;
    case PersonPhase::closing:
      if (view.object == nullptr ||
          hand_to_surface(view) > kPalmDistance + manners.taking_hold_gap) {
        give_up();
      } else if (phase_time() > manners.person_close_time) {
        wants_grip_ = true;
        second_hand_.join(hand_target_);
        from_ = hand_target_;
        enter(PersonPhase::pulling);
      }
      break;
    case PersonPhase::pulling:
      pull(dt, view);
      break;
    case PersonPhase::withdrawing:
      withdraw(dt, view);
      break;
    case PersonPhase::keeping:
      if (settings_.kind == PersonKind::giver || settings_.kind == PersonKind::partner) {
        hold_object(view);
      } else {
        hand_target_ = carry_position();
        if (settings_.kind == PersonKind::fetcher) end_keeping(view);
      }
      break;
    case PersonPhase::retracting:
      retract(dt);
      break;
    case PersonPhase::offering:
      offer(dt, view);
      break;
    case PersonPhase::darting:
      continue_dart(dt, view);
      break;
    case PersonPhase::leaving:
      walk_away();
      break;
    case PersonPhase::putting:
      put_down();
      break;
    case PersonPhase::guided:
      break;
  }
}

/// Returns whether the object is not where this person takes objects from: the robot's hand, or for
/// a fetcher the place where the object stands.
bool PersonModel::is_unavailable(const PersonView& view) const {
  return view.held_by_robot == (settings_.kind == PersonKind::fetcher);
}

bool PersonModel::is_offered_to(const PersonView& view, int side) const {
  const PersonManners& manners = settings_.manners;
  const double max_speed = settings_.behaviour.early ? manners.taking_max_early_offer_speed
                                                     : manners.taking_max_offer_speed;
  if (refusing_ || view.object == nullptr || is_unavailable(view) ||
      view.object_velocity.norm() > max_speed)
    return false;
  if (settings_.kind == PersonKind::fetcher && clock_ < settings_.fetches_at) return false;
  // An object that the robot has only begun to lift is not offered to anybody.
  const bool is_lifted =
      settings_.kind != PersonKind::taker || !p_object_at_grasp_ ||
      (view.T_world_object.translation() - *p_object_at_grasp_).norm() >= manners.taking_min_lift;
  if (!is_lifted) return false;
  if (settings_.kind == PersonKind::partner && announcement_ != Announcement::offers) return false;
  return (object_centre(view) - shoulder(side)).norm() <
         reach_ + (settings_.recording ? manners.recorded_max_step : manners.taking_lean_reach);
}

/// Selects the preferred hand, unless the other hand is clearly nearer or only the other reaches
/// the object.
void PersonModel::choose_hand(const PersonView& view) {
  if (settings_.recording || view.object == nullptr) return;
  const Side preferred = preferred_side();
  const double right = (object_centre(view) - shoulder(1)).norm(),
               left_distance = (object_centre(view) - shoulder(0)).norm();
  const double own = preferred == Side::right ? right : left_distance,
               other = preferred == Side::right ? left_distance : right;
  const PersonManners& manners = settings_.manners;
  const double max_own = reach_ + manners.taking_lean_reach - manners.taking_hand_margin;
  const bool change = !has_changed_hands() && (own > other + manners.taking_hand_advantage ||
                                               (own > max_own && other < own));
  side_ = change == (preferred == Side::right) ? Side::left : Side::right;
}

/// Returns the lean with which the straight arm reaches a point [rad].
double PersonModel::lean_to_reach(const Vector3& p_hand) const {
  const double excess =
      (p_hand - shoulder(hand_index())).norm() - settings_.manners.person_max_reach * reach_;
  return std::clamp(lean_ + excess / std::max(0.2, template_[kShoulder[hand_index()]].z() -
                                                       template_[kWaist].z()),
                    0.0, settings_.manners.person_max_lean);
}

void PersonModel::watch(double dt, const PersonView& view) {
  cooldown_ = std::max(0.0, cooldown_ - dt);
  const bool takes = settings_.kind == PersonKind::taker || settings_.kind == PersonKind::partner ||
                     settings_.kind == PersonKind::recording ||
                     settings_.kind == PersonKind::fetcher;
  if (settings_.behaviour.readies)
    raise_hand_in_advance(dt, view);
  else if (offer_time_ <= 0)
    choose_hand(view);
  offer_time_ = takes && cooldown_ <= 0 && is_offered_to(view, hand_index()) ? offer_time_ + dt : 0;
  if (offer_time_ <= 0) return taking_.forget();
  if (chooses_place()) choose_place(view);
  const PersonManners& manners = settings_.manners;
  if (offer_time_ < (settings_.recording ? manners.recorded_reaction : settings_.reaction)) return;
  if (chooses_place() && !has_places(view)) return;
  offer_time_ = 0;
  side_of_object_ = side_to_take(view);
  from_ = hand_point();
  const Vector3 goal = grasp_point(view);
  const double reach_time =
      manners.taking_reach_time + manners.taking_time_per_distance * (goal - from_).norm();
  duration_ = std::clamp(reach_time, manners.taking_min_reach_time, manners.taking_max_reach_time) /
              settings_.behaviour.speed_scale;
  lean_from_ = lean_;
  begin_with_second_hand();
  lean_to_ = taking_.has_place() ? lean_to_places(view) : lean_to_reach(goal);
  hand_target_ = from_;
  hand_active_ = !settings_.recording;
  raise_progress_ = 0;
  playback_ = 0;
  if (settings_.recording) {
    home_ = feet_;
    step_ = (goal - recorded_contact(home_)).cwiseProduct(Vector3(1, 1, 0));
    if (step_.norm() > manners.recorded_max_step) step_ *= manners.recorded_max_step / step_.norm();
  }
  enter(PersonPhase::reaching);
}

void PersonModel::reach_out(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  const double max_speed = settings_.behaviour.early ? manners.taking_max_early_target_speed
                                                     : manners.taking_max_target_speed;
  const bool is_target_lost = refusing_ || view.object == nullptr || is_unavailable(view) ||
                              view.object_velocity.norm() > max_speed;
  exit_time_ = is_target_lost ? exit_time_ + dt : 0;
  if (exit_time_ > manners.taking_lost_time) return give_up();
  if (view.object == nullptr) return;
  const double s = reach_fraction();
  lean_ = lean_from_ + s * (lean_to_ - lean_from_);
  hand_target_ = taking_.has_place()
                     ? taking_.position_at(from_, s, manners.taking_curve, view.T_world_object)
                     : Vector3(from_ + s * (grasp_point(view) - from_));
  second_hand_.reach(s, manners.taking_curve, view.T_world_object);
  if (s >= manners.person_midway && settings_.behaviour.withdraws && !first_attempt_over_)
    return give_up();
  if (s < 1) return;
  const bool is_other_there =
      !second_hand_.is_active() ||
      hand_to_surface(view, second_hand_.target()) < kPalmDistance + manners.taking_touch_gap;
  if (is_other_there && hand_to_surface(view) < kPalmDistance + manners.taking_touch_gap) {
    second_hand_.join(hand_target_);
    enter(PersonPhase::closing);
  } else if (phase_time() > reach_duration() + manners.taking_contact_time) {
    give_up();
  }
}

void PersonModel::replay(double dt, const PersonView& view) {
  const Recording& recording = *settings_.recording;
  const PersonManners& manners = settings_.manners;
  const bool is_target_lost = refusing_ || view.object == nullptr || !view.held_by_robot ||
                              view.object_velocity.norm() > manners.taking_max_target_speed;
  exit_time_ = is_target_lost ? exit_time_ + dt : 0;
  if (exit_time_ > manners.recorded_lost_time ||
      phase_time() > recording.contact + manners.recorded_contact_time)
    return give_up();
  playback_ = std::min(playback_ + dt, recording.contact);
  feet_ =
      home_ +
      min_jerk(playback_ / std::max(0.1, recording.contact - manners.recorded_warp_time)) * step_;
  place_body();
  const Vector3 recorded = points_[kHand[hand_index()]];
  if (view.object != nullptr) {
    const Vector3 p_recorded_contact = recorded_contact(home_ + step_);
    warp_ = nearest_grasp_point(view, p_recorded_contact) - p_recorded_contact;
    if (warp_.norm() > manners.recorded_max_warp) warp_ *= manners.recorded_max_warp / warp_.norm();
  }
  const double s = min_jerk(1 - (recording.contact - playback_) / manners.recorded_warp_time);
  hand_active_ = s > 0;
  hand_target_ = recorded + s * warp_;
  if (playback_ >= recording.contact && view.object != nullptr &&
      hand_to_surface(view) < kPalmDistance + manners.taking_touch_gap)
    enter(PersonPhase::closing);
}

void PersonModel::pull(double dt, const PersonView& view) {
  if (!wants_grip_ || view.object == nullptr) return give_up();
  const Vector3 direction =
      (carry_position() - hand_target_).cwiseProduct(Vector3(1, 1, 0)).normalized();
  const PersonManners& manners = settings_.manners;
  const double ramp = std::min(1.0, phase_time() / manners.taking_pull_rise);
  const double pull_force = view.grip_force.dot(direction);
  const double speed =
      std::clamp(manners.taking_pull_admittance * (ramp * settings_.pull - pull_force),
                 -manners.taking_max_pull_speed, manners.taking_max_pull_speed);
  hand_target_ += speed * dt * direction;
  overload_time_ =
      view.grip_force.norm() > manners.person_max_tolerated_force ? overload_time_ + dt : 0;
  exit_time_ = view.held_by_robot ? 0 : exit_time_ + dt;
  const double moved = (hand_target_ - from_).dot(direction);
  if (overload_time_ > manners.taking_overload_time ||
      phase_time() > manners.taking_max_pull_time || moved < -manners.taking_max_pulled_back) {
    give_up();
  } else if (exit_time_ > manners.taking_free_time ||
             (moved > manners.taking_min_pull_travel &&
              pull_force < manners.taking_pull_drop * settings_.pull)) {
    from_ = hand_target_;
    duration_ = manners.taking_withdraw_time;
    lean_from_ = lean_;
    home_ = feet_;
    held_below_ = extent_below_hand(view);
    enter(PersonPhase::withdrawing);
  }
}

void PersonModel::withdraw(double dt, const PersonView& view) {
  if (!wants_grip_) return give_up();
  const PersonManners& manners = settings_.manners;
  overload_time_ =
      view.grip_force.norm() > manners.person_max_tolerated_force ? overload_time_ + dt : 0;
  if (overload_time_ > manners.taking_carry_overload_time) return give_up();
  // The force is limited, and the hand yields where the object or the hand itself is caught.
  const Vector3 direction = (carry_position() - from_).stableNormalized();
  const double force = std::max(view.grip_force.norm(), view.arm_force.dot(direction));
  const double rate = manners.taking_max_pull_ratio - force / settings_.pull;
  progress_ = std::max(
      0.0, progress_ + dt / duration_ * std::clamp(rate, -manners.taking_max_yield_rate, 1.0));
  const double s = min_jerk(progress_);
  lean_ = (1 - s) * lean_from_;
  if (!settings_.behaviour.seated) feet_ = home_ - s * manners.taking_step_back * forward();
  hand_target_ = from_ + s * (carry_position() - from_);
  if (progress_ < 1) return;
  from_ = hand_target_;
  enter(PersonPhase::keeping);
}

void PersonModel::give_up() {
  wants_grip_ = false;
  first_attempt_over_ = true;
  cooldown_ = settings_.manners.taking_cooldown;
  from_ = hand_active_ ? hand_target_ : hand_point();
  hand_active_ = true;
  hand_target_ = from_;
  second_hand_.begin_return(settings_.manners.taking_curve);
  lean_from_ = lean_;
  duration_ = settings_.manners.person_retract_time;
  warp_.setConstant(playback_);
  const Vector3 rest = rest_position();
  retract_control_ = hand_configuration_ ? TakingHand::behind(from_, settings_.manners.taking_curve,
                                                              hand_configuration_->R_world_hand)
                                         : Vector3((from_ + rest) / 2);
  enter(PersonPhase::retracting);
}

void PersonModel::retract(double) {
  const double s = min_jerk(phase_time() / duration_);
  lean_ = (1 - s) * lean_from_;
  playback_ = settings_.recording ? (1 - s) * warp_.x() : 0;
  hand_target_ =
      (1 - s) * (1 - s) * from_ + 2 * s * (1 - s) * retract_control_ + s * s * rest_position();
  if (phase_time() < duration_) return;
  hand_active_ = false;
  playback_ = 0;
  enter(PersonPhase::watching);
}

void PersonModel::continue_dart(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  const Vector3 to = view.robot_hand - hand_target_;
  const double speed = std::min(speed_, manners.person_dart_hand_acceleration * phase_time());
  const double move = std::min(speed * dt, std::max(0.0, to.norm() - manners.person_dart_gap));
  if (to.norm() > 1e-6) hand_target_ += move / to.norm() * to;
  const Vector3 beyond = hand_target_ - shoulder(hand_index());
  const Vector3 missing_reach =
      std::max(0.0, 1 - manners.person_max_reach * reach_ / beyond.norm()) *
      beyond.cwiseProduct(Vector3(1, 1, 0));
  feet_speed_ = std::min(feet_speed_ + manners.person_dart_trunk_acceleration * dt,
                         missing_reach.norm() / dt);
  if (feet_speed_ > 0) feet_ += feet_speed_ * dt * missing_reach.normalized();
  if (phase_time() > manners.person_dart_time) give_up();
}

}  // namespace handsel::sim
