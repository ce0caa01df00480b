// SPDX-License-Identifier: Apache-2.0
// The robot on the wire: what its driver reports, what it is commanded. Axis order = actuated
// joints of the robot description.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

enum class DriveMode : std::uint8_t {
  off,
  braked,
  enabled,
  protective_stop,
  user_stop,
  emergency_stop
};

/// Measurements of a hand other than the first one.
struct OtherHand {
  std::string group;     ///< its axes
  Wrench wrist_wrench;   ///< frame of its palm
  double hand_effort{};  ///< sum of |finger torques| [Nm]
  /// Mass it carries as measured by the robot side [kg]; noise may make it negative.
  double payload{};
};

/// What the servos of the robot side follow or hold.
struct ServoReference {
  Vector position;  ///< per axis [rad] ([m]); empty if unknown
  Vector effort;    ///< per axis, feed-forward of the motors besides following [Nm] ([N]); or empty
  double payload{};       ///< mass in the first hand that the servos allow for [kg]
  Vector other_payloads;  ///< mass in each other hand that the servos allow for [kg]
};

/// Published by the robot side (driver or simulator), 500 Hz. Topic RobotState, profile sensor,
/// keyed by robot.
struct RobotState {
  Stamp stamp{};             ///< time of measurement, UTC [ns]; 0: filled in by the bus
  std::string robot;         ///< name of the robot description
  std::uint64_t sequence{};  ///< grows by one per sample; falls when the robot side restarts
  /// Root of the robot's model in the world: its root link; of one that drives, the frame in which
  /// the place of its platform is measured (odometry).
  Pose T_world_base{Pose::Identity()};
  double localisation_age{};          ///< since that frame was observed; 0: it does not drive [s]
  Vector position, velocity, effort;  ///< per axis [rad, rad/s, Nm] (m, m/s, N for prismatic)
  ServoReference reference{};         ///< what the servos follow or hold
  Vector external_torque;  ///< per axis, without model gravity and friction [Nm]; empty if unknown
  /// What the world exerts on the hand with its load, gravity of the hand removed, tool frame.
  Wrench wrist_wrench;
  double hand_effort{};            ///< sum of |finger torques| [Nm]
  double payload{};                ///< mass the hand carries as measured by the robot side [kg]
  DriveMode mode{DriveMode::off};  ///< state of the drives
  /// Of a robot with several arms; the fields above speak of the first hand.
  std::vector<OtherHand> other_hands{};
  std::uint64_t refused_set_points{};  ///< set-points the robot side has refused so far
  /// Why the last one was refused, while the robot is at rest because of that; else empty.
  std::string refusal{};
};

/// Set-point of every axis, from the trajectory controller only. Topic JointCommand, profile
/// setpoint, keyed by robot.
struct JointCommand {
  Stamp stamp{};             ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string robot;         ///< name of the robot description; the key of the topic
  std::uint64_t sequence{};  ///< grows by one per set-point
  /// All axes of the robot [rad, rad/s, rad/s^2] ([m, m/s, m/s^2]).
  Vector position, velocity, acceleration;
  /// Per axis, feed-forward of the motors besides following [Nm] ([N]); empty: none.
  Vector effort;
  /// Mass the first hand holds, for the robot side's own model; 0: nothing or unknown [kg].
  double payload{};
  /// Mass each other hand holds, in the order of RobotState::other_hands [kg]; or empty.
  Vector other_payloads{};
};

}  // namespace handsel
