// SPDX-License-Identifier: Apache-2.0
// How fast a part of a fitted body moves in a given direction: the measured v_h of speed and
// separation monitoring (SSM, ISO 10218-2:2025; formulas: section 2).
#pragma once

#include <algorithm>
#include <initializer_list>

#include "common/model/human/human_body.hpp"

namespace handsel {

/// Indices into kBodyJoints of the joints that carry a part.
inline std::initializer_list<int> joints_of(BodyPart part) {
  static constexpr std::initializer_list<int> head{0, 1}, torso{1, 2, 3, 4, 8, 12, 15},
      upper_arm_left{4, 5}, forearm_left{5, 6}, hand_left{6, 7}, upper_arm_right{8, 9},
      forearm_right{9, 10}, hand_right{10, 11}, leg_left{12, 13, 14}, leg_right{15, 16, 17};
  switch (part) {
    case BodyPart::head:
      return head;
    case BodyPart::torso:
      return torso;
    case BodyPart::upper_arm_left:
      return upper_arm_left;
    case BodyPart::forearm_left:
      return forearm_left;
    case BodyPart::hand_left:
      return hand_left;
    case BodyPart::upper_arm_right:
      return upper_arm_right;
    case BodyPart::forearm_right:
      return forearm_right;
    case BodyPart::hand_right:
      return hand_right;
    case BodyPart::leg_left:
      return leg_left;
    case BodyPart::leg_right:
      return leg_right;
  }
  return torso;
}

/// Largest speed [m/s] of the part's joints along `direction` (unit, world); may be negative.
/// `person` must be a complete body in the order of kBodyJoints; otherwise the largest over
/// whatever joints there are. 0 without joints.
inline double directed_speed(const Person& person, BodyPart part, const Vector3& direction) {
  if (person.joints.empty()) return 0.0;
  double fastest = -1e9;
  if (person.joints.size() == kBodyJoints.size()) {
    for (int j : joints_of(part))
      fastest =
          std::max(fastest, person.joints[static_cast<std::size_t>(j)].velocity.dot(direction));
  } else {
    for (const BodyJoint& joint : person.joints)
      fastest = std::max(fastest, joint.velocity.dot(direction));
  }
  return fastest;
}

}  // namespace handsel
