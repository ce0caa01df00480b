// SPDX-License-Identifier: Apache-2.0
// An object that is to be picked up is seen, at rest and in nobody's hand: until then it is
// searched for.
#pragma once

#include <string>

#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

/// Waits until an object is seen at rest in no hand of a person. Fails with where the object was
/// last seen, or who has it, at `deadline`. References must outlive the routine.
Routine<Outcome> await_object(Parts& parts, const std::string& object, TimePoint deadline);

/// Returns the target of a motion that ends when the object in the scene moves from its place.
ObjectTarget object_at_rest(const Parts& parts, const std::string& object);

}  // namespace handsel::manipulation_planner
