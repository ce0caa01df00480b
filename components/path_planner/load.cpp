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
  out.temperature_factor = s.temperature_factor;
  out.max_refusals = s.max_refusals;
  out.goal_bias = s.goal_bias;
  out.max_refinement_fraction = s.max_refinement_fraction;
  out.search_fraction = s.search_fraction;
  out.cost_step = s.cost_step;
  out.length_weight = s.length_weight;
  out.smoothing_rounds = s.smoothing_rounds;
  out.max_idle_rounds = s.max_idle_rounds;
  out.perturbations = s.perturbations;
  out.max_prune_loss = s.max_prune_loss;
  out.max_edge = s.max_edge;
  out.max_attempts = s.max_attempts;
  out.fine_step_ratio = s.fine_step_ratio;
  out.first_tree_checks = s.first_tree_checks;
  out.first_budget_fraction = s.first_budget_fraction;
  out.near_ends = s.near_ends;
  return out;
}

CartesianSettings cartesian_settings(const settings::PathPlannerSettings& s) {
  CartesianSettings out;
  out.metre = s.cartesian_metre;
  out.elbow = s.cartesian_elbow;
  out.range = s.cartesian_range;
  out.step = s.cartesian_step;
  out.largest_step = s.cartesian_max_step;
  out.goal_bias = s.cartesian_goal_bias;
  out.goal_elbows = s.cartesian_goal_elbows;
  out.shortcuts = s.cartesian_shortcuts;
  out.initial_temperature = s.cartesian_initial_temperature;
  out.temperature_factor = s.temperature_factor;
  out.max_refusals = s.max_refusals;
  out.attempts = s.cartesian_attempts;
  out.branch_goals = s.branch_goals;
  out.max_branch_offset = s.max_branch_offset;
  out.min_bend = s.min_branch_bend;
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
  out.live.reach = s.live_join_reach;
  out.live.piece = s.live_piece;
  out.live.verify_step = s.live_verify_step;
  out.live.max_drop_loss = s.live_max_drop_loss;
  out.live.max_drop_gain = s.live_max_drop_gain;
  out.cartesian = cartesian_settings(s);
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
