// SPDX-License-Identifier: Apache-2.0
// The text of a robot description, with what it extends.
#pragma once

#include <filesystem>

#include "common/config/schema/robot.pb.h"
#include "common/model/robot_model.hpp"

namespace handsel {

/// Reads a robot description and joins it to those that it extends: what it gives itself comes
/// before what they give, lists are joined. Paths of those are absolute then. Throws ConfigError /
/// MissingError naming the file, also where descriptions extend each other in a circle.
config::RobotDescription read_robot_text(const std::filesystem::path& description);

/// The robot with the axes of its platform (common/model/platform.hpp). Throws ConfigError.
RobotModel with_platform_axes(const RobotModel& robot, const config::PlatformDescription& platform,
                              const std::filesystem::path& description);

}  // namespace handsel
