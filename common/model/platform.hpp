// SPDX-License-Identifier: Apache-2.0
// A robot that drives: place and heading of its platform as axes. A robot whose description says
// that it drives has them always; others get them for planning only.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

inline constexpr const char* kPlatformGroup = "platform";  ///< x, y, heading
/// Axes of the platform, then those of the group "arm"; its tip is the arm's.
inline constexpr const char* kWholeRobotGroup = "robot";
/// Largest |x| and |y| of the platform in the world [m].
inline constexpr double kPlatformExtent = 20.0;

/// Returns whether place and heading of the platform are axes of the robot.
bool drives(const RobotModel& robot);

/// The robot with three more axes after its own: x, y [m] and heading [rad] of its root link in the
/// world, which is the root of this model; with the groups above. A robot that drives is returned
/// as it is. nullopt where the description has no platform. Throws ConfigError.
std::optional<RobotModel> on_platform(const RobotModel& robot,
                                      const std::filesystem::path& description);

/// All axes of a robot that does not drive, then where its platform is.
Vector with_platform(const Vector& q, const Pose& T_world_base);

/// All axes of a robot that drives, with its platform at x, y [m], heading [rad] in the root frame.
Vector with_platform_at(const RobotModel& robot, const Vector& q, const Vector3& place);

/// Where the platform of a robot that drives stands: x, y [m], heading [rad] in the root frame.
Vector3 platform_place(const RobotModel& robot, const Vector& q);

/// Returns where the platform stands in the world: of a robot that does not drive, its root link.
Pose T_world_platform(const RobotModel& robot, const Vector& q, const Pose& T_world_base);

/// Returns the same for the robot as a scene has it; before that is known, the root link.
Pose T_world_platform(const RobotModel& robot, const Scene& scene);

/// Where the heading is the same, and nearest to `near` [rad].
double nearest_heading(double heading, double near);

}  // namespace handsel
