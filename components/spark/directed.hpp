// SPDX-License-Identifier: Apache-2.0
// Joints by name, and directed speeds.
#pragma once

#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::spark {

/// Returns a joint of a complete body.
inline const BodyJoint& joint_of(const Person& person, const char* name) {
  return person.joints[static_cast<std::size_t>(body_joint_index(name))];
}

/// Returns the speed from `from` toward `to` [m/s]; 0 if both coincide.
inline double speed_toward(const Vector3& from, const Vector3& velocity, const Vector3& to) {
  const Vector3 gap = to - from;
  const double distance = gap.norm();
  return distance > 1e-6 ? velocity.dot(gap) / distance : 0.0;
}

}  // namespace handsel::spark
