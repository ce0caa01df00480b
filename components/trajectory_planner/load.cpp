// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/load.hpp"

namespace handsel::trajectory_planner {

Settings core_settings(const settings::TrajectoryPlannerSettings& file) {
  Settings out;
  out.blend_step = file.corner_step;
  out.speed = {file.cost_step,
               {file.min_speed_factor, file.min_acceleration_factor, file.min_jerk_factor},
               file.concern_radius,
               file.approach_speed,
               file.approach_factor,
               file.unseen_angle,
               file.unseen_factor,
               file.unseen_transition};
  out.tool.allowed_excess = file.allowed_excess;
  out.tool.elbow_weight = file.elbow_weight;
  const auto sped = [](RateBounds& bounds, double velocity) {
    const double factor = velocity / bounds.velocity;
    bounds = {velocity, factor * bounds.acceleration, factor * bounds.jerk};
  };
  sped(out.tool.translation, file.tool_speed);
  sped(out.tool.rotation, file.tool_turn_speed);
  sped(out.tool.elbow, file.tool_turn_speed);
  return out;
}

}  // namespace handsel::trajectory_planner
