// Settings of the emulated world; values and meanings as in common/config/schema/sim.proto.
#pragma once

#include <filesystem>

#include "common/robot_side/robot_side.hpp"
#include "sim/oracle/separation_oracle.hpp"
#include "sim/people/person_hand.hpp"
#include "sim/physics/grip.hpp"
#include "sim/robot/robot_body.hpp"

namespace handsel::sim {

struct SimSettings {
  double step{0.001};  ///< [s]
  int solver_iterations{10};
  double state_rate{500}, truth_rate{50};  ///< [Hz]
  ServoSettings servo;
  PadSettings pad;
  bool constraint{true};  ///< a force-capped constraint helps to hold while the contacts pass force closure
  RobotSideSettings robot_side;
  GripSettings robot_grip, person_grip;
  PersonHandSettings person_hand;
  double touch_force{0.2};      ///< [N]
  double grasp_time{0.02};      ///< [s]
  double lose_time{0.05};       ///< [s]
  double wrench_filter{25};     ///< [Hz]
  double force_noise{0.1};      ///< [N]
  double position_noise{1e-5};  ///< [rad]
  double coverage{4};           ///< [m]
  double setpoint_period{0};    ///< [s], 0: measured
  // With simulated time only (sim/time_keeper):
  double clock_period{0.01};  ///< one grant lets the components' time advance by this [s]
  double max_lag{0.005};      ///< steps may come this much after their time before time stands still [s]
  double max_wait{0.5};       ///< for a component that does not answer, or for set-points [s]
  SsmSettings ssm;
  std::filesystem::path data_root;  ///< where relative recordings are found; empty: nowhere
};

/// The environment's HANDSEL_DATA, else ../shared/data beside the project, else empty.
std::filesystem::path data_root();

/// Reads <folder>/sim.txtpb, and the period of the set-points from <folder>/trajectory_controller.txtpb; data_root as above. Throws
/// ConfigError naming file and field.
SimSettings load_settings(const std::filesystem::path& folder);

}  // namespace handsel::sim
