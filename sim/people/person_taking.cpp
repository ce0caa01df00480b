// SPDX-License-Identifier: Apache-2.0
// How a person takes an object from a robot's hand: a place on the object, the configuration of the
// hand.
#include <limits>

#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

namespace {

constexpr double kLeanStep = 0.01;  // step of the search for a lean [rad]

}  // namespace

HumanHand PersonModel::hand_shape(int side) const {
  const double wrist = (template_[kHand[side]] - template_[kWrist[side]]).norm();
  return {side == 0 ? Side::left : Side::right, settings_.stature, wrist};
}

/// Returns whether the person looks for a place that the robot leaves free. The hands of people
/// from outside have no orientation, and what a fetcher takes no robot holds.
bool PersonModel::chooses_place() const {
  return (settings_.kind == PersonKind::taker || settings_.kind == PersonKind::partner) &&
         !settings_.recording;
}

/// Returns the preferred side of an offered object: toward the person and away from the robot's
/// hand, world, unit.
Vector3 PersonModel::side_to_take(const PersonView& view) const {
  const Vector3 centre = object_centre(view);
  const Vector3 toward =
      (shoulder(hand_index()) - centre).cwiseProduct(Vector3(1, 1, 0)).normalized();
  const Vector3 away = (centre - view.robot_hand).cwiseProduct(Vector3(1, 1, 0.3));
  return (toward + (away.norm() > 1e-3
                        ? Vector3(settings_.taking.taking_away_weight * away.normalized())
                        : Vector3(Vector3::Zero())))
      .normalized();
}

FreeGraspQuery PersonModel::place_query(const ObjectModel& object, const HumanArm& arm) const {
  static const std::vector<HandPart> nothing;
  FreeGraspQuery query;
  query.object = &object;
  query.arm = arm;
  const int s = arm.side == Side::left ? 0 : 1;
  query.arm.shoulder = upright_shoulder(s);
  query.forward = forward();
  query.trunk = trunk();
  query.wrist = (template_[kHand[s]] - template_[kWrist[s]]).norm();
  query.robot = &nothing;
  return query;
}

/// Returns whether the person takes an object with both hands.
bool PersonModel::needs_both_hands(const ObjectModel& object) const {
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : object.mesh.vertices) box.extend(vertex);
  const double width = box.isEmpty() ? 0.0 : box.sizes().head<2>().maxCoeff();
  return object.mass > settings_.manners.taking_max_one_hand_mass ||
         width > settings_.manners.taking_max_one_hand_width;
}

/// Returns the query for one of both hands: a place on its own side of the object.
FreeGraspQuery PersonModel::place_query_of_both(const PersonView& view, const HumanArm& arm) const {
  FreeGraspQuery query = place_query(*view.object, arm);
  const Vector3 outward = arm.side == Side::left ? left() : Vector3(-left());
  query.T_world_object = view.T_world_object;
  query.beside = outward;
  query.preferred = (outward - forward()).normalized();
  if (view.robot != nullptr) query.robot = view.robot;
  return query;
}

/// Returns whether a place is chosen for each hand that takes the object.
bool PersonModel::has_places(const PersonView& view) const {
  return taking_.has_place() &&
         (!needs_both_hands(*view.object) || second_hand_.taking().has_place());
}

/// Returns the orientation of a hand before a reach, world.
Eigen::Quaterniond PersonModel::hand_at_rest(int side) const {
  const Vector3 fingers = (points_[kHand[side]] - points_[kWrist[side]]).stableNormalized();
  const Vector3 inward = side == 0 ? Vector3(-left()) : left();
  Eigen::Matrix3d R;
  R.col(2) = fingers;
  R.col(0) = (inward - inward.dot(fingers) * fingers).stableNormalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return Eigen::Quaterniond(R);
}

/// Moves the other hand of a person who takes with both hands: with the handover hand, or back to
/// rest.
void PersonModel::move_second_hand() {
  if (!second_hand_.is_active()) return;
  switch (phase_) {
    case PersonPhase::reaching:
      return;
    case PersonPhase::closing:
    case PersonPhase::pulling:
    case PersonPhase::withdrawing:
    case PersonPhase::keeping:
    case PersonPhase::offering:
    case PersonPhase::leaving:
      return second_hand_.follow(hand_target_);
    case PersonPhase::retracting:
      return second_hand_.come_back(min_jerk(phase_time() / duration_),
                                    rest_position(1 - hand_index()));
    default:
      return second_hand_.come_back(1, rest_position(1 - hand_index()));
  }
}

/// Returns whether the hand holds an object that the person gives in a chosen place.
bool PersonModel::gives_from_place() const {
  return (settings_.kind == PersonKind::giver || settings_.kind == PersonKind::partner) &&
         wants_grip_ && taking_.has_place();
}

/// Chooses a place that leaves a receiver room on a held object; returns the position of the object
/// in the frame of hand(), nullopt: there is none.
std::optional<Vector3> PersonModel::choose_place_to_give(const ObjectModel& object,
                                                         const Eigen::Quaterniond& turn) {
  const PersonManners& manners = settings_.manners;
  const auto arm = human_arm(body_, side_);
  if (!arm) return std::nullopt;
  FreeGraspQuery query = place_query(object, *arm);
  query.T_world_object = make_pose(comfortable_reach(body_, side_), facing() * turn);
  const Vector3 outward = side_ == Side::left ? left() : Vector3(-left());
  query.preferred =
      (manners.giving_outward_weight * outward - manners.giving_back_weight * forward())
          .normalized();
  query.avoided = held_in_vain_;
  // The end toward the robot, of an upright object the upper end.
  const Vector3 away = forward() + Vector3::UnitZ();
  double max_away = -std::numeric_limits<double>::infinity();
  for (const Vector3& vertex : object.mesh.vertices) {
    const Vector3 p = query.T_world_object * vertex;
    if (p.dot(away) > max_away) max_away = p.dot(away), query.p_left = p;
  }
  TakingHand chosen;
  if (!chosen.hold(query, hand_shape(hand_index()), settings_.taking)) return std::nullopt;
  taking_ = chosen;
  const Vector3 p_hand = taking_.goal(query.T_world_object).translation();
  return facing().inverse() * (query.T_world_object.translation() - p_hand);
}

std::optional<Pose> PersonModel::hold_from_beginning(const ObjectModel& object,
                                                     const Eigen::Quaterniond& turn) {
  if (settings_.kind != PersonKind::giver && !settings_.holds) return std::nullopt;
  if (needs_both_hands(object)) return hold_with_both(object, turn);
  const auto p_hand_object = choose_place_to_give(object, turn);
  if (!p_hand_object) return std::nullopt;
  return make_pose(*p_hand_object, turn);
}

/// Returns where both hands offer an object: between the comfortable places of the hands [m].
Vector3 PersonModel::middle_of_reach() const {
  return 0.5 * (comfortable_reach(body_, Side::left) + comfortable_reach(body_, Side::right));
}

/// Chooses a place for each hand and raises the object before the trunk; returns the pose of the
/// object in the frame of hand(), nullopt: a hand has no place.
std::optional<Pose> PersonModel::hold_with_both(const ObjectModel& object,
                                                const Eigen::Quaterniond& turn) {
  const auto arm = human_arm(body_, side_), other_arm = human_arm(body_, other_side(side_));
  if (!arm || !other_arm) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : object.mesh.vertices) box.extend(vertex);
  const bool is_along = box.sizes().x() > box.sizes().y();
  const Eigen::Quaterniond across(Eigen::AngleAxisd(is_along ? M_PI_2 : 0, Vector3::UnitZ()));
  const int s = 1 - hand_index();
  PersonView view;
  view.object = &object;
  view.T_world_object = make_pose(middle_of_reach(), facing() * turn * across);
  TakingHand leading;
  if (!leading.hold(place_query_of_both(view, *arm), hand_shape(hand_index()), settings_.taking) ||
      !second_hand_.taking().hold(place_query_of_both(view, *other_arm), hand_shape(s),
                                  settings_.taking))
    return std::nullopt;
  taking_ = leading;
  R_world_rest_ = hand_at_rest(hand_index());
  const Pose T_world_hand = taking_.goal(view.T_world_object);
  second_hand_.begin(second_hand_.taking().goal(view.T_world_object).translation(),
                     hand_at_rest(s));
  second_hand_.join(T_world_hand.translation());
  hand_configuration_ = taking_.configuration(R_world_rest_, 1, 1, view.T_world_object);
  second_hand_.configure(1, 1, view.T_world_object);
  bend_ = 1;
  hand_target_ = from_ = carry_position();
  second_hand_.follow(hand_target_);
  step(0, PersonView{});
  return make_pose(
      facing().inverse() * (view.T_world_object.translation() - T_world_hand.translation()),
      turn * across);
}

/// Returns whether the robot's hand is so far from the object that a person holds it anew.
bool PersonModel::is_robot_hand_far(const PersonView& view) const {
  return view.object != nullptr && (view.robot_hand - object_centre(view)).norm() >
                                       settings_.manners.giving_min_hand_distance;
}

/// Chooses the grasp of an object that a partner gives back, or that was offered in vain, anew
/// while the robot's hand is far: none in which the object was offered in vain, while the hand has
/// another place.
void PersonModel::hold_to_give_back(const PersonView& view) {
  p_hand_object_to_give_.reset();
  if (uses_both_hands()) return;
  const bool gives_anew = settings_.kind == PersonKind::partner || !held_in_vain_.empty();
  if (!gives_anew || !taking_.has_place() || view.held_by_robot || !is_robot_hand_far(view)) return;
  const Eigen::Quaterniond turn(facing().inverse() * view.T_world_object.linear());
  p_hand_object_to_give_ = choose_place_to_give(*view.object, turn);
  if (p_hand_object_to_give_ || held_in_vain_.empty()) return;
  held_in_vain_.clear();
  p_hand_object_to_give_ = choose_place_to_give(*view.object, turn);
}

/// Remembers that the object was offered in vain in the present grasp.
void PersonModel::remember_hold() {
  if (gives_from_place()) held_in_vain_.push_back(taking_.goal(Pose::Identity()));
}

/// Changes the grasp of an object that the robot has not taken; keeps it where the hand has
/// no other place.
void PersonModel::hold_otherwise(const PersonView& view) {
  if (!gives_from_place() || uses_both_hands() || !is_robot_hand_far(view)) return;
  remember_hold();
  const Eigen::Quaterniond turn(facing().inverse() * view.T_world_object.linear());
  const auto p_hand_object = choose_place_to_give(*view.object, turn);
  if (p_hand_object)
    p_hand_object_to_give_ = p_hand_object;
  else
    held_in_vain_.clear();
}

void PersonModel::choose_place(const PersonView& view) {
  const auto arm = human_arm(body_, side_);
  if (!arm) return;
  held_in_vain_.clear();
  const auto other_arm = human_arm(body_, other_side(side_));
  if (needs_both_hands(*view.object) && other_arm) {
    taking_.choose(place_query_of_both(view, *arm), hand_shape(hand_index()), settings_.taking);
    second_hand_.taking().choose(place_query_of_both(view, *other_arm),
                                 hand_shape(1 - hand_index()), settings_.taking);
  } else {
    FreeGraspQuery query = place_query(*view.object, *arm);
    query.T_world_object = view.T_world_object;
    query.preferred = side_to_take(view);
    if (view.robot != nullptr) query.robot = view.robot;
    taking_.choose(query, hand_shape(hand_index()), settings_.taking);
  }
  if (taking_.has_place()) R_world_rest_ = hand_at_rest(hand_index());
}

/// Returns the height of the shoulder above the waist [m].
double PersonModel::trunk() const {
  return template_[kShoulder[hand_index()]].z() - template_[kWaist].z();
}

/// Returns the displacement of the shoulder by a lean [m].
Vector3 PersonModel::by_leaning(double lean) const {
  return trunk() * (std::sin(lean) * forward() + (std::cos(lean) - 1) * Vector3::UnitZ());
}

Vector3 PersonModel::upright_shoulder(int side) const { return shoulder(side) - by_leaning(lean_); }

/// Returns the min lean with which the wrist of a hand reaches a place, else the lean that comes
/// nearest [rad].
double PersonModel::lean_to_take(const Pose& T, int s) const {
  const double palm = (template_[kHand[s]] - template_[kWrist[s]]).norm();
  const Vector3 p_wrist = T.translation() - palm * T.linear().col(2);
  const Vector3 upright = upright_shoulder(s);
  const double max_distance = settings_.manners.taking_lean_from * (reach_ - palm);
  const int steps =
      std::max(1, static_cast<int>(std::ceil(settings_.manners.person_max_lean / kLeanStep)));
  double nearest = 0, min_distance = std::numeric_limits<double>::infinity();
  double lean = 0;
  for (int i = 0; i < steps; ++i, lean += kLeanStep) {
    const double distance = (p_wrist - upright - by_leaning(lean)).norm();
    if (distance <= max_distance) return lean;
    if (distance < min_distance) min_distance = distance, nearest = lean;
  }
  return nearest;
}

/// Returns the lean with which each hand that takes the object reaches its place [rad].
double PersonModel::lean_to_places(const PersonView& view) const {
  const double lean = lean_to_take(taking_.goal(view.T_world_object), hand_index());
  if (!second_hand_.is_active()) return lean;
  return std::max(lean,
                  lean_to_take(second_hand_.taking().goal(view.T_world_object), 1 - hand_index()));
}

/// Begins the reach of the second hand, where the person takes the object with both.
void PersonModel::begin_with_second_hand() {
  const int s = 1 - hand_index();
  if (second_hand_.taking().has_place()) second_hand_.begin(points_[kHand[s]], hand_at_rest(s));
}

/// Updates the configuration of the handover hand: a fist, except while the hand takes, holds in a
/// chosen place, or moves back without an object.
void PersonModel::update_hand(double dt, const PersonView& view) {
  const PersonManners& manners = settings_.manners;
  switch (phase_) {
    case PersonPhase::watching:
      bend_ = 0;
      if (!second_hand_.is_active() && offer_time_ <= 0) second_hand_.forget();
      return hand_configuration_.reset();
    case PersonPhase::reaching:
    case PersonPhase::closing:
    case PersonPhase::pulling:
    case PersonPhase::withdrawing: {
      if (!taking_.has_place() || view.object == nullptr) return;
      const bool reaches = phase_ == PersonPhase::reaching, closes = phase_ == PersonPhase::closing;
      const double turned = reaches ? min_jerk(reach_fraction() / manners.taking_turned_at) : 1;
      const double closed = reaches  ? 0
                            : closes ? std::min(1.0, phase_time() / manners.person_close_time)
                                     : 1;
      hand_configuration_ =
          taking_.configuration(R_world_rest_, turned, closed, view.T_world_object);
      second_hand_.configure(turned, closed, view.T_world_object);
      bend_ = phase_ == PersonPhase::withdrawing ? 1 - min_jerk(progress_) : 1;
      return;
    }
    case PersonPhase::retracting:
      if (hand_configuration_) {
        for (double& closure : hand_configuration_->closures)
          closure = std::max(0.0, closure - dt / manners.person_close_time);
      }
      second_hand_.open(dt / manners.person_close_time);
      bend_ = 1 - min_jerk(phase_time() / duration_);
      return taking_.forget();
    default:
      if (gives_from_place() && view.object != nullptr) {
        hand_configuration_ = taking_.configuration(R_world_rest_, 1, 1, view.T_world_object);
        second_hand_.configure(1, 1, view.T_world_object);
        bend_ = 1;
        return;
      }
      bend_ = 0;
      hand_configuration_.reset();
      taking_.forget();
      second_hand_.forget();
  }
}

}  // namespace handsel::sim
