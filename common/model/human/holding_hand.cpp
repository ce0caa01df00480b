// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/holding_hand.hpp"

#include <algorithm>

#include "common/model/human/hand_closure.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/human/palm.hpp"
#include "common/model/object_surface.hpp"

namespace handsel {

namespace {

template <typename P>
auto* joint(P& person, const char* name) {
  const auto it = std::find_if(person.joints.begin(), person.joints.end(),
                               [&](const BodyJoint& j) { return j.name == name; });
  return it == person.joints.end() ? nullptr : &*it;
}

/// Returns the direction from a point to the surface of an object, unit vector.
Vector3 direction_to(const ObjectModel& object, const Vector3& p) {
  constexpr double kStep = 1e-4;  // of the finite differences [m]
  Vector3 toward;
  for (int i = 0; i < 3; ++i) {
    const Vector3 step = kStep * Vector3::Unit(i);
    toward[i] = surface_distance(object, p - step) - surface_distance(object, p + step);
  }
  return toward.stableNormalized();
}

/// Returns the frame of a hand, as in HumanHand, with an unobserved palm toward the object;
/// nullopt: the fingers point at the object.
std::optional<Pose> hand_frame(const HoldingHand& holding, const ObjectModel& object) {
  constexpr double kMinAcross = 0.3;  // min sine of the angle between fingers and palm direction
  const Vector3& p_hand = holding.p_hand;
  const Vector3 fingers = (p_hand - holding.p_wrist).stableNormalized();
  const auto across_fingers = [&](const Vector3& v) {
    return Vector3(v - v.dot(fingers) * fingers);
  };
  Vector3 palm = Vector3::Zero();
  if (holding.palm) palm = across_fingers(holding.palm->stableNormalized());
  if (palm.norm() < kMinAcross) palm = across_fingers(direction_to(object, p_hand));
  if (palm.norm() < kMinAcross) return std::nullopt;
  Pose T = Pose::Identity();
  T.linear().col(0) = palm.normalized();
  T.linear().col(2) = fingers;
  T.linear().col(1) = fingers.cross(palm.normalized());
  T.translation() = p_hand;
  return T;
}

}  // namespace

Person with_fingers_bent(const Person& person, const Vector3& p_world_object) {
  Person bent = person;
  BodyJoint *left = joint(bent, "l_hand"), *right = joint(bent, "r_hand");
  if (left == nullptr || right == nullptr) return bent;
  const bool is_left =
      (left->position - p_world_object).norm() < (right->position - p_world_object).norm();
  BodyJoint& hand = is_left ? *left : *right;
  const BodyJoint* wrist = joint(bent, is_left ? "l_wrist" : "r_wrist");
  if (wrist == nullptr) return bent;
  const Vector3 palm = hand.position - wrist->position;
  double fingers = 0.0;
  for (const BodyCapsule& part : body_capsules(person))
    if (part.part == (is_left ? BodyPart::hand_left : BodyPart::hand_right))
      fingers = (part.b - hand.position).norm();
  hand.position -= std::min(fingers, 0.5 * palm.norm()) * palm.stableNormalized();
  return bent;
}

std::optional<HoldingHand> holding_hand(const Person& person, const ObjectModel& object,
                                        const Pose& T_world_object) {
  const Pose T_object_world = T_world_object.inverse();
  const auto* left = joint(person, "l_hand");
  const auto* right = joint(person, "r_hand");
  if (left == nullptr || right == nullptr) return std::nullopt;
  const Vector3 p_left = T_object_world * left->position,
                p_right = T_object_world * right->position;
  const bool is_left = surface_distance(object, p_left) < surface_distance(object, p_right);
  const auto* wrist = joint(person, is_left ? "l_wrist" : "r_wrist");
  if (wrist == nullptr) return std::nullopt;
  const Side side = is_left ? Side::left : Side::right;
  HoldingHand holding{side, T_object_world * wrist->position, is_left ? p_left : p_right};
  if (const auto palm = palm_of(person, side)) holding.palm = T_object_world.linear() * *palm;
  return holding;
}

void move_hand(Person& person, const HoldingHand& to, const Pose& T_world_object) {
  const bool is_left = to.side == Side::left;
  if (BodyJoint* wrist = joint(person, is_left ? "l_wrist" : "r_wrist"))
    wrist->position = T_world_object * to.p_wrist;
  if (BodyJoint* hand = joint(person, is_left ? "l_hand" : "r_hand"))
    hand->position = T_world_object * to.p_hand;
  if (!to.palm) return;
  for (PalmDirection& palm : person.palms)
    if (palm.joint == (is_left ? "l_hand" : "r_hand"))
      palm.normal = (T_world_object.linear() * *to.palm).stableNormalized();
}

std::vector<HandPart> assumed_digits(const Person& person, const ObjectModel& object,
                                     const Pose& T_world_object, double turn) {
  const auto holding = holding_hand(person, object, T_world_object);
  if (!holding) return {};
  auto T_object_hand = hand_frame(*holding, object);
  if (!T_object_hand) return {};
  T_object_hand->rotate(Eigen::AngleAxisd(turn, Vector3::UnitZ()));
  const HumanHand hand(holding->side, person.stature, (holding->p_hand - holding->p_wrist).norm());
  std::array<std::optional<double>, kDigits> contacts;
  for (int d = 0; d < kDigits; ++d) {
    if (const auto contact = first_contact(hand, d, object, *T_object_hand))
      contacts[d] = contact->closure;
  }
  std::vector<HandPart> digits;
  for (int d = 0; d < kDigits; ++d) {
    for (const HandPart& part : hand.digit(d, contacts[d].value_or(free_closure(d, contacts))))
      digits.push_back(transformed(*T_object_hand, part));
  }
  return digits;
}

OtherRobot digits_as_obstacles(const Person& person, const ObjectModel& object,
                               const Pose& T_world_object, double margin,
                               const std::vector<double>& turns) {
  OtherRobot out{"digits of " + person.id, {}, 0};
  for (const double turn : turns) {
    for (const HandPart& part : assumed_digits(person, object, T_world_object, turn)) {
      const HandPart placed = transformed(T_world_object, part);
      MovingPart digit;
      digit.a = placed.a;
      digit.b = placed.b;
      digit.radius = placed.radius + margin;
      out.parts.push_back(digit);
    }
  }
  return out;
}

}  // namespace handsel
