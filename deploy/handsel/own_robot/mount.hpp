// SPDX-License-Identifier: Apache-2.0
// Where a hand is attached to a bare arm, and what of the arm's URDF is the hand.
#pragma once

#include <filesystem>
#include <string>

#include "common/model/robot_model.hpp"
#include "deploy/handsel/own_robot/robot_parts.hpp"

namespace handsel {

/// Returns the pose of a palm (z outward) on the flange of an arm, in the flange's frame: z along
/// the last axis of the arm, away from the wrist, beyond the collision shapes near that axis.
Pose mount_pose(const RobotModel& robot, const RobotParts& parts);

/// Writes the part of a URDF below a link as a URDF of its own with that link as root; meshes get
/// absolute paths. Throws ConfigError when the file cannot be written.
void write_hand_urdf(const std::filesystem::path& urdf, const RobotModel& robot,
                     const RobotParts& parts, const std::filesystem::path& to);

}  // namespace handsel
