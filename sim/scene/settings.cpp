// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/settings.hpp"

#include <cstdlib>
#include <string>

#include "common/config/resources.hpp"
#include "common/config/settings/sim.hpp"
#include "common/config/settings/trajectory_controller.hpp"
#include "common/config/settings_text.hpp"

namespace handsel::sim {

namespace {

/// Compares settings of people with each other; throws ConfigError.
void check_people(const settings::SimSettings& read, const SettingsText& text) {
  const PersonManners& m = read.person;
  const auto check = [&text](double low, double high, const char* key, const char* other) {
    if (low > high) text.refuse(key, std::string("must be at most ") + other);
  };
  check(read.free_grasp.taking_place_max_lean, m.person_max_lean, "taking_place_max_lean",
        "person_max_lean");
  check(m.taking_max_offer_speed, m.taking_max_target_speed, "taking_max_offer_speed",
        "taking_max_target_speed");
  check(m.taking_max_early_offer_speed, m.taking_max_early_target_speed,
        "taking_max_early_offer_speed", "taking_max_early_target_speed");
  check(m.taking_min_reach_time, m.taking_max_reach_time, "taking_min_reach_time",
        "taking_max_reach_time");
  check(m.taking_touch_gap, m.taking_hold_gap, "taking_touch_gap", "taking_hold_gap");
  check(m.external_min_motion, m.external_max_motion, "external_min_motion", "external_max_motion");
}

}  // namespace

std::filesystem::path data_root() {
  if (const char* data = std::getenv("HANDSEL_DATA")) return data;
  const std::filesystem::path beside = resource_root() / "../../shared/data";
  return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

SimSettings load_settings(const std::filesystem::path& folder) {
  SettingsText text;
  const auto read = settings::read_sim_settings(folder / "sim.txtpb", &text);
  check_people(read, text);
  const auto controller =
      settings::read_trajectory_controller_settings(folder / "trajectory_controller.txtpb");
  SimSettings s;
  s.step = read.step;
  s.solver_iterations = read.solver_iterations;
  s.state_rate = read.state_rate;
  s.ground_truth_rate = read.ground_truth_rate;
  s.servo.bandwidth = read.servo_bandwidth;
  s.robot_side.max_gap = read.max_setpoint_gap;
  s.robot_side.max_ahead = s.robot_side.max_gap;
  s.robot_side.period = controller.period;
  s.robot_side.min_stop = read.min_stop;
  s.max_setpoint_age = read.max_setpoint_age;
  s.robot_grip.max_force = read.grip_force;
  s.robot_grip.max_torque = read.grip_torque;
  s.person_grip.max_force = read.person_grip_force;
  s.person_two_hand_grip.max_force = read.person_two_hand_force;
  s.collision_force = read.collision_force;
  s.taking = read.free_grasp;
  s.manners = read.person;
  s.touch_force = read.touch_force;
  s.grasp_time = read.grasp_time;
  s.lose_time = read.lose_time;
  s.wrench_filter = read.wrench_filter;
  s.force_noise = read.force_noise;
  s.position_noise = read.position_noise;
  s.coverage = read.coverage;
  s.ssm.reaction = read.reaction;
  s.odometry = {read.odometry_noise, read.odometry_turn_noise};
  s.localisation = {read.localisation_rate, read.localisation_noise, read.localisation_turn_noise,
                    read.localisation_filter};
  s.constraint = std::getenv("HANDSEL_HELP_HOLD") != nullptr;
  s.setpoint_period = read.setpoint_period;
  s.pad.friction = read.pad_friction;
  s.pad.patch = read.pad_patch;
  s.pad.stiffness = read.pad_stiffness;
  s.servo.finger_travel = read.finger_travel;
  s.servo.rotor_inertia = read.rotor_inertia;
  s.clock_period = read.clock_period;
  s.max_lag = read.max_lag;
  s.max_wait = read.max_wait;
  s.data_root = data_root();
  return s;
}

}  // namespace handsel::sim
