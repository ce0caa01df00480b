// SPDX-License-Identifier: Apache-2.0
// What of an object is seen past the hand that holds it. Own method.
#pragma once

#include "components/grasp_planner/hand/hand_shape.hpp"

namespace handsel::grasp_planner {

/// Share, [0, 1], of the surface that an eye at `p_object_eye` would see were there no hand: points
/// that face it with nothing of the object before them. `hand`: placed in the object's frame;
/// solids without a closed form count as the boxes around them. 0 when there is nothing to see. At
/// most 240 of the object's points are sampled.
double visible_fraction(const Graspable& object, const HandShape::PlacedHand& hand,
                        const Vector3& p_object_eye);

}  // namespace handsel::grasp_planner
