// SPDX-License-Identifier: Apache-2.0
// Settings of the emulated world; values and meanings as in common/config/schema/sim.proto.
#pragma once

#include <filesystem>

#include "common/robot_side/robot_side.hpp"
#include "sim/oracle/separation_oracle.hpp"
#include "sim/people/person_hand.hpp"
#include "sim/physics/grip.hpp"
#include "sim/robot/platform_odometry.hpp"
#include "sim/robot/robot_body.hpp"

namespace handsel::sim {

struct SimSettings {
  double step{0.001};                             ///< physics step [s]
  int solver_iterations{10};                      ///< of the contact solver in one step
  double state_rate{500}, ground_truth_rate{50};  ///< of robot state and ground truth [Hz]
  ServoSettings servo;                            ///< joint servos of the robot
  PadSettings pad;                                ///< surface of its fingers
  /// A grasp constraint of limited force helps to hold while the contacts pass force closure.
  bool constraint{false};
  RobotSideSettings robot_side;  ///< handling of set-points by the robot's driver
  double max_setpoint_age{0.1};  ///< older set-points are left out [s]
  /// Grasp constraint of a robot's hand, grip of a person's hand.
  GripSettings robot_grip, person_grip;
  GripSettings person_two_hand_grip;  ///< each hand of a person who holds an object with both
  PersonHandSettings person_hand;     ///< free hand of a person on its spring
  FreeGraspSettings taking;           ///< choice of a place on an object that the robot holds
  PersonManners manners;              ///< behaviour of all people
  double collision_force{0.5};        ///< min normal force of a collision of the robot [N]
  double touch_force{0.2};            ///< min normal force of a contact for force closure [N]
  double grasp_time{0.02};            ///< duration of force closure that begins a grasp [s]
  double lose_time{0.05};             ///< duration without force closure that ends a grasp [s]
  double wrench_filter{25};           ///< cut-off of the wrench and torque measurement [Hz]
  double force_noise{0.1};            ///< standard deviation of a measured force [N]
  double position_noise{1e-5};        ///< standard deviation of a measured position [rad]
  double coverage{4};                 ///< half width of a sensor's default coverage [m]
  double setpoint_period{0};          ///< period of set-points [s]; 0: measured
  OdometrySettings odometry;          ///< odometry of a platform
  LocalisationSettings localisation;  ///< localisation of a platform
  // With simulated time only (sim/time_keeper):
  double clock_period{0.01};        ///< time by which one grant advances the components [s]
  double max_lag{0.005};            ///< max delay of a step before the time of the system waits [s]
  double max_wait{0.5};             ///< max wait for a component or for set-points [s]
  SsmSettings ssm;                  ///< settings of the separation oracle
  std::filesystem::path data_root;  ///< folder of relative recordings; empty: none
};

/// Returns the environment's HANDSEL_DATA, else ../shared/data beside the project, else empty.
std::filesystem::path data_root();

/// Reads <folder>/sim.txtpb, and the period of set-points from
/// <folder>/trajectory_controller.txtpb; data_root as data_root(). Throws ConfigError that names
/// file and field.
SimSettings load_settings(const std::filesystem::path& folder);

}  // namespace handsel::sim
