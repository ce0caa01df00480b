// A robot that drives: place and heading of its platform as axes, for planning. The robot that is
// controlled has none.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "common/model/robot_model.hpp"

namespace handsel {

inline constexpr const char* kPlatformGroup = "platform";  ///< x, y, heading
/// Axes of the platform, then those of the group "arm"; its tip is the arm's.
inline constexpr const char* kWholeRobotGroup = "robot";
/// Largest |x| and |y| of the platform in the world [m].
inline constexpr double kPlatformExtent = 20.0;

/// The robot with three more axes after its own: x, y [m] and heading [rad] of its root link in the
/// world, which is the root of this model; with the groups above. nullopt where the description
/// has no platform. Throws ConfigError.
std::optional<RobotModel> on_platform(const RobotModel& robot,
                                      const std::filesystem::path& description);

/// All axes of the robot, then where its platform is.
Vector with_platform(const Vector& q, const Pose& T_world_base);

/// Where the heading is the same, and nearest to `near` [rad].
double nearest_heading(double heading, double near);

}  // namespace handsel
