// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/load.hpp"

#include "common/model/platform.hpp"

namespace handsel::path_planner {
namespace {

Settings core_settings(const settings::PathPlannerSettings& s) {
  Settings out;
  out.step = s.step;
  out.verify_step = s.verify_step;
  out.connect_range = s.connect_range;
  out.transition_range = s.transition_range;
  out.initial_temperature = s.initial_temperature;
  out.search_fraction = s.search_fraction;
  out.cost_step = s.cost_step;
  out.length_weight = s.length_weight;
  out.smoothing_rounds = s.smoothing_rounds;
  out.max_idle_rounds = s.max_idle_rounds;
  out.max_edge = s.max_edge;
  out.max_attempts = s.max_attempts;
  out.first_budget_fraction = s.first_budget_fraction;
  out.near_ends = s.near_ends;
  return out;
}

}  // namespace

SolverSettings solver_settings(const settings::PathPlannerSettings& s) {
  SolverSettings out;
  out.search = core_settings(s);
  out.live.min_gain = s.live_gain;
  out.live.rounds = s.live_rounds;
  out.live.tries = s.live_tries;
  out.live.near_ends = s.live_near_ends;
  out.replan_margins = {s.live_margin, s.live_turning_margin};
  out.roam = s.roam;
  out.furniture = {s.furniture_room, s.end_room_fraction};
  out.driven_room_fraction = s.driven_room_fraction;
  out.head_room = s.head_room;
  out.sampling.tries = s.platform_tries;
  out.sampling.max_distance = s.max_platform_distance;
  return out;
}

std::optional<RobotModel> mobile_of(const RobotModel& robot,
                                    const std::filesystem::path& description) {
  if (description.empty()) return std::nullopt;
  return on_platform(robot, description);
}

}  // namespace handsel::path_planner
