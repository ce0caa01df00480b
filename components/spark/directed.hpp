// Joints by name, and how fast something moves toward something.
#pragma once

#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::spark {

/// Of a complete body.
inline const BodyJoint& joint_of(const Person& person, const char* name) {
  return person.joints[static_cast<std::size_t>(body_joint_index(name))];
}

/// [m/s]; 0 when it is there.
inline double speed_toward(const Vector3& from, const Vector3& velocity, const Vector3& to) {
  const Vector3 gap = to - from;
  const double distance = gap.norm();
  return distance > 1e-6 ? velocity.dot(gap) / distance : 0.0;
}

}  // namespace handsel::spark
