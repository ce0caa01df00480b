#include "common/model/human/holding_hand.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"

namespace handsel {

namespace {

BodyJoint* joint(Person& person, const char* name) {
  const auto it = std::find_if(person.joints.begin(), person.joints.end(),
                               [&](const BodyJoint& j) { return j.name == name; });
  return it == person.joints.end() ? nullptr : &*it;
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

}  // namespace handsel
