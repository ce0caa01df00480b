// What the path planner reads when it starts.
#pragma once

#include <optional>

#include "common/bus/node_context.hpp"
#include "common/config/settings/path_planner.hpp"
#include "components/path_planner/solver.hpp"

namespace handsel::path_planner {

/// Returns the settings of the planners from those of the file.
SolverSettings solver_settings(const settings::PathPlannerSettings& file);
/// Returns the robot on its platform; nullopt: its description names none.
std::optional<RobotModel> mobile_of(const NodeContext& context);

}  // namespace handsel::path_planner
