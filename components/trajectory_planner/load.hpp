// SPDX-License-Identifier: Apache-2.0
// Reads the settings of the trajectory planner at its start.
#pragma once

#include "common/config/settings/trajectory_planner.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"

namespace handsel::trajectory_planner {

/// Returns the settings of the planner from those of the file. Accelerations and jerks of the tool
/// are scaled with its speeds.
Settings core_settings(const settings::TrajectoryPlannerSettings& file);

}  // namespace handsel::trajectory_planner
