// SPDX-License-Identifier: Apache-2.0
// Reads the settings and models of the path planner at its start.
#pragma once

#include <filesystem>
#include <optional>

#include "common/config/settings/path_planner.hpp"
#include "components/path_planner/solver.hpp"

namespace handsel::path_planner {

/// Returns the settings of the planners from those of the file.
SolverSettings solver_settings(const settings::PathPlannerSettings& file);
/// Returns the robot on the platform of its description; nullopt: no platform, or empty
/// description.
std::optional<RobotModel> mobile_of(const RobotModel& robot,
                                    const std::filesystem::path& description);

}  // namespace handsel::path_planner
