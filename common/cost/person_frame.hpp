// SPDX-License-Identifier: Apache-2.0
// Front and gaze of a person.
#pragma once

#include <optional>

#include "common/messages/world.hpp"

namespace handsel {

/// The joint of that name, or nullptr.
const BodyJoint* find_joint(const Person&, const char* name);

/// Torso axes as columns in the world: forward, left, up. Upright facing +x where the shoulders are
/// not known.
Eigen::Matrix3d torso_axes(const Person&);

struct Sight {
  Vector3 eyes{Vector3::Zero()};        ///< world [m]
  Vector3 direction{Vector3::UnitX()};  ///< unit
};
/// The person's gaze; where it is unknown the body's front as seen from the head stands in for it;
/// nullopt: not even a head is known.
std::optional<Sight> sight_of(const Person&);

}  // namespace handsel
