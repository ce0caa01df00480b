// The hand of a person that holds something.
#pragma once

#include "common/messages/world.hpp"

namespace handsel {

/// The same person, the nearer hand of whom holds something at `p_world_object` [m]: its fingers
/// are bent around that instead of stretched out through it, so its capsule ends in the middle of
/// the hand and covers the half of the object that faces the palm. A person without a wrist or a
/// hand joint is returned unchanged. Own method: stretched fingers would reach through the object.
Person with_fingers_bent(const Person&, const Vector3& p_world_object);

}  // namespace handsel
