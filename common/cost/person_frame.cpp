// SPDX-License-Identifier: Apache-2.0
#include "common/cost/person_frame.hpp"

namespace handsel {

const BodyJoint* find_joint(const Person& person, const char* name) {
  for (const BodyJoint& joint : person.joints)
    if (joint.name == name) return &joint;
  return nullptr;
}

Eigen::Matrix3d torso_axes(const Person& person) {
  const BodyJoint *left = find_joint(person, "l_shoulder"),
                  *right = find_joint(person, "r_shoulder"), *waist = find_joint(person, "waist");
  Vector3 up = Vector3::UnitZ(), across = Vector3::UnitY();
  if (left && right) {
    across = left->position - right->position;
    if (waist) up = 0.5 * (left->position + right->position) - waist->position;
  }
  if (up.norm() < 1e-6) up = Vector3::UnitZ();
  up.normalize();
  across -= up * up.dot(across);
  if (across.norm() < 1e-6) across = up.unitOrthogonal();
  across.normalize();
  Eigen::Matrix3d axes;
  axes.col(0) = across.cross(up);
  axes.col(1) = across;
  axes.col(2) = up;
  return axes;
}

std::optional<Sight> sight_of(const Person& person) {
  if (person.gaze_known) return Sight{person.gaze_origin, person.gaze_direction.normalized()};
  const BodyJoint* head = find_joint(person, "head");
  if (head == nullptr) return std::nullopt;
  return Sight{head->position, torso_axes(person).col(0)};
}

}  // namespace handsel
