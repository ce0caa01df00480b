// SPDX-License-Identifier: Apache-2.0
// A picture of a robot's capsules at rest, from two sides.
#pragma once

#include "common/model/robot_model.hpp"
#include "deploy/handsel/pictures/png.hpp"

namespace handsel {

/// Draws shapes (pale) and capsules (a colour for arm, hand and the rest) from the right and from
/// the front, each `size` [px] wide; a red stick of 0.1 m points from the tool link along
/// `tool_direction` (tool frame).
Picture robot_picture(const RobotModel& robot, const Vector& q, const Vector3& tool_direction,
                      int size);

}  // namespace handsel
