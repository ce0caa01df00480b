// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/settings.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/config/settings/trajectory_controller.hpp"
#include "common/config/settings_text.hpp"

namespace handsel::trajectory_controller {

namespace {

StopProofSettings read_stop_proof(const settings::ControllerStopProof& in,
                                  const SettingsText& text) {
  StopProofSettings s;
  s.latency = in.latency;
  s.robot_side_delay = in.robot_side_delay;
  s.tracker_error = in.tracker_error;
  s.speed_error = in.speed_error;
  s.robot_error = in.robot_error;
  s.limit_ratio = in.limit_ratio;
  s.limit_margin = in.limit_margin;
  s.min_contact_ratio = in.min_contact_ratio;
  s.finger_ratio = in.finger_ratio;
  s.max_rejoins = in.max_rejoins;
  s.shown_time = in.shown_time;
  s.min_robot_mass = in.min_robot_mass;
  s.min_finger_mass = in.min_finger_mass;
  std::array<bool, kBodyRegions> given{};
  for (const auto& region : in.regions) {
    const auto found =
        std::find(std::begin(kBodyRegionNames), std::end(kBodyRegionNames), region.region);
    if (found == std::end(kBodyRegionNames))
      text.refuse("stop_proof",
                  "stop_proof.regions names \"" + region.region +
                      "\"; known are head, torso, upper_arm, forearm, hand, thigh and lower_leg");
    const auto k = static_cast<std::size_t>(found - std::begin(kBodyRegionNames));
    if (std::exchange(given[k], true))
      text.refuse("stop_proof",
                  "stop_proof.regions gives " + region.region + " twice; once is right");
    s.contact[k] = {region.force, region.stiffness, region.mass};
    s.people[k] = {region.speed, region.acceleration};
  }
  for (std::size_t k = 0; k < kBodyRegions; ++k)
    if (!given[k])
      text.refuse("stop_proof", std::string("stop_proof.regions lacks ") + kBodyRegionNames[k]);
  return s;
}

/// Checks the consistency of related limits.
void check_together(const settings::TrajectoryControllerSettings& in, const SettingsText& text) {
  constexpr double kMinStep = 1e-6;  // [s]
  if (!(in.forecast_slow >= in.forecast_hold + kMinStep))
    text.refuse("forecast_slow", "must be above forecast_hold");
  if (!(in.look_far_ahead >= in.look_ahead))
    text.refuse("look_far_ahead", "must be at least look_ahead");
  if (!(in.guard.speed_floor <= in.guard.speed_max))
    text.refuse("guard", "speed_floor must be at most speed_max");
  if (!(in.guard.speed_unknown <= in.guard.speed_max))
    text.refuse("guard", "speed_unknown must be at most speed_max");
  if (!(in.view.floor < in.view.ceiling)) text.refuse("view", "floor must be below ceiling");
}

void read_timeouts(const settings::TrajectoryControllerSettings& in, ControllerSettings& s) {
  const auto& t = in.timeouts;
  s.timeouts.robot_state = t.robot_state;
  s.timeouts.human_state = t.human_state;
  s.timeouts.forecast = t.forecast;
  s.timeouts.attention = t.attention;
  s.timeouts.supervisor = t.supervisor;
  s.timeouts.localisation = t.localisation;
}

void read_guard(const settings::TrajectoryControllerSettings& in, ControllerSettings& s) {
  const auto& g = in.guard;
  s.guard.speed_max = g.speed_max;
  s.guard.speed_floor = g.speed_floor;
  s.guard.speed_uncertainty = g.speed_uncertainty;
  s.guard.speed_unknown = g.speed_unknown;
  s.guard.unknown_after = g.unknown_after;
  s.guard.reaction = g.reaction;
  s.guard.intrusion = g.intrusion;
  s.guard.uncertainty_human = g.uncertainty_human;
  s.guard.uncertainty_robot = g.uncertainty_robot;
  s.guard.uncovered_factor = g.uncovered_factor;
  s.guard.handover_speed = g.handover_speed;
  s.guard.handover_range = g.handover_range;
  s.guard.sideways_ratio = g.sideways_ratio;
  s.guard.away_ratio = g.away_ratio;
  s.guard.stop_persistence = g.stop_persistence;
  s.guard.finger_stop_speed = g.finger_stop_speed;
}

void read_checks(const settings::TrajectoryControllerSettings& in, ControllerSettings& s) {
  s.rest_check_cycles = in.rest_check_cycles;
  s.blind_check_cycles = in.blind_check_cycles;
  s.finger_check_cycles = in.finger_check_cycles;
  s.retreat_check_cycles = in.retreat_check_cycles;
  s.retreat_aim_cycles = in.retreat_aim_cycles;
  s.reference = {in.reference_bent, in.reference_apart, in.reference_check_cycles};
  s.bound_noise = {in.bound_noise, in.finger_bound_noise};
}

void read_view(const settings::TrajectoryControllerSettings& in, ControllerSettings& s) {
  const auto& v = in.view;
  s.view.require_view = v.require_view;
  s.view.max_view_age = v.max_view_age;
  s.view.margin = v.margin;
  s.view.ahead_margin = v.ahead_margin;
  s.view.boundary_factor = v.boundary_factor;
  s.view.floor = v.floor;
  s.view.ceiling = v.ceiling;
}

void read_contact(const settings::TrajectoryControllerSettings& in, ControllerSettings& s) {
  const auto& c = in.contact;
  s.contact.torque = c.torque;
  s.contact.time = c.time;
  s.contact.usual_time = c.usual_time;
  s.contact.follow_torque = c.follow_torque;
  s.contact.max_usual = c.max_usual;
  s.contact.handover_torque = c.handover_torque;
  s.contact.clamp_time = c.clamp_time;
  s.contact.yield_torque = c.yield_torque;
  s.contact.yield_time = c.yield_time;
}

void read_hand(const settings::TrajectoryControllerSettings& in, ControllerSettings& s) {
  const auto& h = in.hand;
  s.hand.grasp_speed = h.grasp_speed;
  s.hand.min_closing = h.min_closing;
  s.hand.touch_effort = h.touch_effort;
  s.hand.touch_time = h.touch_time;
  s.hand.seek_speed = h.seek_speed;
  s.hand.seek_travel = h.seek_travel;
  s.hand.seek_min_effort = h.seek_min_effort;
  s.hand.grip_fraction = h.grip_fraction;
  s.hand.grip_effort = h.grip_effort;
  s.hand.grip_rise_time = h.grip_rise_time;
  s.hand.settle_time = h.settle_time;
  s.hand.min_contacts = h.min_contacts;
  s.hand.min_push = h.min_push;
  s.hand.lost_payload = h.lost_payload;
  s.hand.lost_time = h.lost_time;
  s.hand.loosen_fraction = h.loosen_fraction;
  s.hand.yield_effort = h.yield_effort;
  s.hand.yield_speed = h.yield_speed;
  s.hand.person_range = h.person_range;
  s.hand.lever = h.lever;
  s.hand.pull.baseline_time = h.pull_baseline;
  s.hand.pull.filter_time = h.pull_filter;
  s.hand.pull.quick_time = h.pull_quick;
  s.hand.pull.hold_time = h.pull_hold;
  s.hand.pull.impulse = h.pull_impulse;
  s.hand.pull.commit_time = h.pull_commit;
  s.hand.pull.slack_fraction = h.slack_fraction;
  s.hand.pull.slack_time = h.slack_time;
  s.hand.pull.min_load = h.slack_min_load;
  s.hand.pull.lasts_fraction = h.pull_lasts;
  s.hand.pull.lost_time = h.load_back;
  s.hand.pull.timeout = h.release_timeout;
  s.hand.pull.direction_cosine = h.pull_cosine;
  s.hand.pull.away_cosine = h.pull_away_cosine;
}

void read_walls(const settings::TrajectoryControllerSettings& in, const SettingsText& text,
                ControllerSettings& s) {
  for (const auto& w : in.walls) {
    const Vector3 normal(w.nx, w.ny, w.nz);
    if (!(normal.norm() > 1e-9))
      text.refuse("walls", "a wall has no normal; nx, ny, nz must not all be 0");
    s.walls.push_back({normal.normalized(), w.offset});
  }
  if (in.workspace) {
    const auto& b = *in.workspace;
    if (!(b.x_min < b.x_max && b.y_min < b.y_max && b.z_min < b.z_max))
      text.refuse("workspace", "each _min of workspace must be below its _max");
    s.walls.push_back({Vector3::UnitX(), b.x_min});
    s.walls.push_back({-Vector3::UnitX(), -b.x_max});
    s.walls.push_back({Vector3::UnitY(), b.y_min});
    s.walls.push_back({-Vector3::UnitY(), -b.y_max});
    s.walls.push_back({Vector3::UnitZ(), b.z_min});
    s.walls.push_back({-Vector3::UnitZ(), -b.z_max});
  }
}

}  // namespace

ControllerSettings load_settings(const std::filesystem::path& file) {
  SettingsText text;
  const auto in = settings::read_trajectory_controller_settings(file, &text);
  check_together(in, text);
  ControllerSettings s;
  s.period = in.period;
  s.attention_lost_factor = in.attention_lost_factor;
  s.recoil_limit = in.recoil_limit;
  s.max_command_age = in.max_command_age;
  s.refusal_time = in.refusal_time;
  s.start_tolerance = in.start_tolerance;
  s.cost_from = in.cost_from;
  s.cost_factor = in.cost_factor;
  s.yield_speed = in.yield_speed;
  s.yield_reach = in.yield_reach;
  s.yield_lead = in.yield_lead;
  s.retreat_speed = in.retreat_speed;
  s.retreat_reach = in.retreat_reach;
  s.retreat_range = in.retreat_range;
  s.retreat_damping = in.retreat_damping;
  s.retreat_min_factor = in.retreat_min_factor;
  s.dry_run = in.dry_run;
  s.switch_reach = in.switch_reach;
  s.join_time = in.join_time;
  s.rejoin_time = in.rejoin_time;
  s.rejoin_tries = static_cast<int>(in.rejoin_tries);
  s.alike_distance = in.alike_distance;
  s.alike_ratio = in.alike_ratio;
  s.tracking_tolerance = in.tracking_tolerance;
  s.tracking_time = in.tracking_time;
  s.forecast_hold = in.forecast_hold;
  s.forecast_slow = in.forecast_slow;
  s.stop_slack = in.stop_slack;
  s.slow_slack = in.slow_slack;
  s.too_fast_ratio = in.too_fast_ratio;
  s.too_fast_margin = in.too_fast_margin;
  s.head_dead_band = in.head_dead_band;
  s.head_min_target_motion = in.head_min_target_motion;
  s.head_clearance = in.head_clearance;
  s.look_ahead = in.look_ahead;
  s.look_far_ahead = in.look_far_ahead;
  s.ahead_min_factor = in.ahead_min_factor;
  s.back_min_factor = in.back_min_factor;
  s.rise = {in.period, in.rise_rate, in.stop_proof.unproven_ratio, in.stop_proof.unproven_rate};
  s.hand_rejoin = in.hand_rejoin;
  s.late_limit = in.late_limit;
  read_checks(in, s);
  read_timeouts(in, s);
  read_guard(in, s);
  s.proof = read_stop_proof(in.stop_proof, text);
  read_view(in, s);
  read_contact(in, s);
  read_hand(in, s);
  read_walls(in, text, s);
  return s;
}

}  // namespace handsel::trajectory_controller
