// SPDX-License-Identifier: Apache-2.0
// What the controller reports: its status, and what moves now. Pure.
#pragma once

#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/hand/hands.hpp"
#include "components/trajectory_controller/input/contact_watch.hpp"
#include "components/trajectory_controller/input/inputs.hpp"
#include "components/trajectory_controller/output/command_report.hpp"
#include "components/trajectory_controller/output/set_points.hpp"
#include "components/trajectory_controller/supervise/stop/stop_space.hpp"
#include "components/trajectory_controller/supervise/supervisor.hpp"

namespace handsel::trajectory_controller {

/// The part of the status that must be reported at once when it changes.
struct StatusKey {
  Mode mode{};                                          ///< of the mode machine
  std::uint64_t epoch{}, trajectory{}, hand_command{};  ///< of the Go; ids of the last commands
  MotionState motion{};                                 ///< of the last trajectory command
  std::uint64_t hands{};                                ///< HandState of each hand, a byte each
  bool operator==(const StatusKey&) const = default;
};

/// What a report is made of.
struct StatusSources {
  const RobotModel& robot;        ///< that is controlled
  const Inputs& inputs;           ///< newest samples
  const Supervisor& supervisor;   ///< mode and causes
  const ArmMotion& arm;           ///< path and motion
  const Hands& hands;             ///< commands and outcomes
  const CommandReport& commands;  ///< accepted and refused
  const SetPoints& set_points;    ///< sent last
  const ContactWatch& contact;    ///< where contact was felt
  const StopSpace& stop_space;    ///< link that is not observed
  const GuardVerdict& nearest;    ///< distances
  std::uint64_t cycles{};         ///< since the start
  bool dry_run{};                 ///< no set-point is sent
};

/// Returns the key of the current status.
StatusKey status_key(const StatusSources& from);
/// Returns the status; stamp left to the publisher.
ExecutionStatus make_status(const StatusSources& from);
/// Returns the motion that is executed; stamp left to the publisher.
ActiveTrajectory make_active(const StatusSources& from);

}  // namespace handsel::trajectory_controller
