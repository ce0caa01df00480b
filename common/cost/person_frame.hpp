// Where a person's front is.
#pragma once

#include "common/messages/world.hpp"

namespace handsel {

/// The joint of that name, or nullptr.
const BodyJoint* find_joint(const Person&, const char* name);

/// Torso axes as columns in the world: forward, left, up. Upright facing +x where the shoulders are not known.
Eigen::Matrix3d torso_axes(const Person&);

}  // namespace handsel
