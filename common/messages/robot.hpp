// The robot on the wire: what its driver reports, what it is told. Axis order = actuated joints of the robot description.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

enum class DriveMode : std::uint8_t { off, braked, enabled, protective_stop, user_stop, emergency_stop };

/// What a hand other than the first one feels.
struct OtherHand {
  std::string group;    ///< its axes
  Wrench wrist_wrench;  ///< frame of its palm
  double hand_effort{};
  double payload{};
};

/// What the servos of the robot side follow or hold.
struct ServoReference {
  Vector position;        ///< per axis [rad] ([m]); empty if unknown
  Vector effort;          ///< per axis, what the motors give besides following [Nm] ([N]); or empty
  double payload{};       ///< mass in the first hand that the servos allow for [kg]
  Vector other_payloads;  ///< the same of the other hands [kg]
};

/// Published by the robot side (driver or simulator), 500 Hz. Topic RobotState, profile sensor, keyed by robot.
struct RobotState {
  Stamp stamp{};
  std::string robot;  ///< name of the robot description
  std::uint64_t sequence{};
  Pose T_world_base{Pose::Identity()};  ///< root link of the robot in the world
  Vector position, velocity, effort;    ///< per axis [rad, rad/s, Nm] (m, m/s, N for prismatic)
  ServoReference reference{};           ///< what the servos follow or hold
  Vector external_torque;               ///< per axis, without model gravity and friction [Nm]; empty if unknown
  Wrench wrist_wrench;                  ///< what the world exerts on the hand with its load, gravity of the hand removed, tool frame
  double hand_effort{};                 ///< sum of |finger torques| [Nm]
  double payload{};                     ///< mass the hand carries as measured by the robot side [kg]
  DriveMode mode{DriveMode::off};
  std::vector<OtherHand> other_hands{};  ///< of a robot with several arms; the fields above speak of the first hand
  std::uint64_t refused_set_points{};    ///< set-points the robot side has refused so far
  std::string refusal{};                 ///< why it refused the last one, while it stands because of that; else empty
};

/// Set-point of every axis, from the trajectory controller only. Topic JointCommand, profile setpoint, keyed by robot.
struct JointCommand {
  Stamp stamp{};
  std::string robot;
  std::uint64_t sequence{};
  Vector position, velocity, acceleration;  ///< per axis, all axes of the robot
  Vector effort;                            ///< likewise, what the motors give besides following [Nm]; empty: nothing
  double payload{};                         ///< mass the first hand holds, for the robot side's own model; 0: nothing or unknown [kg]
  Vector other_payloads{};                  ///< likewise of the other hands, in the order of RobotState::other_hands; or empty [kg]
};

}  // namespace handsel
