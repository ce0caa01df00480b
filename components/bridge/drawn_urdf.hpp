// SPDX-License-Identifier: Apache-2.0
// A URDF made from the model, for robots whose own files a viewer cannot have: put together from
// several, or kept elsewhere.
#pragma once

#include <string>

#include "common/model/robot_model.hpp"

namespace handsel::bridge {

/// All links and joints. Primitives are drawn as they are, what has a mesh by the capsules around
/// it: no other file is needed.
std::string drawn_urdf(const RobotModel& robot);

}  // namespace handsel::bridge
