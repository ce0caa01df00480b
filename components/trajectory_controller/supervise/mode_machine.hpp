// SPDX-License-Identifier: Apache-2.0
// Normal < Slow < Hold < Stop < Fault, with named causes and the rules that clear them
// (architecture: section 1; reliability). Pure.
#pragma once

#include <cstdint>

#include "common/messages/execution.hpp"

namespace handsel::trajectory_controller {

/// Largest ages of the inputs before the mode changes.
struct TimeoutSettings {
  double robot_state{0.02};  ///< Stop [s]
  double human_state{0.2};   ///< Stop [s]
  double forecast{0.1};      ///< Hold, while a trajectory runs [s]
  double attention{0.3};     ///< fixed low factor [s]
  double supervisor{0.3};    ///< Hold at the end of the trajectory [s]
  double localisation{0.5};  ///< Hold: of a platform's place in the world [s]
};

/// Inputs of the machine in one cycle. Ages in s; negative = never seen.
struct ModeInputs {
  /// Ages of the newest RobotState, HumanState, TrajectoryForecast, AttentionAdvice and Go [s].
  double robot_age{-1}, human_age{-1}, forecast_age{-1}, attention_age{-1}, go_age{-1};
  double running_for{};    ///< since the running trajectory started [s]
  bool running{};          ///< a trajectory is not finished
  bool at_rest{};          ///< no axis moves
  bool drive_enabled{};    ///< the robot side reports enabled drives
  bool set_points_late{};  ///< the robot side stands for lack of set-points, drives enabled
  /// The arm is too far from its set-point (Fault); a set-point broke a limit (Fault); too many
  /// late cycles (Hold).
  bool tracking_error{}, limit_violation{}, cycle_late{};
  /// A collision is foreseen within forecast_hold, or within forecast_slow.
  bool forecast_collision_hold{}, forecast_collision_slow{};
  /// Limits of the guard (Slow), too near for too long (Stop), people not covered by observation
  /// (Slow), a wall (Slow), contact while moving (Stop), and a contact that lasts (Stop).
  bool separation_slow{}, separation_stop{}, human_unknown{}, wall_slow{}, contact_stop{},
      clamped{};
  /// Age of the observation of the platform's place; 0: the robot does not drive [s].
  double localisation_age{};
  /// Causes of Slow: attention, human-aware cost ahead, speed override, a set-point without a
  /// checked stop.
  bool attention_slow{}, cost_slow{}, override_slow{}, stop_unproven{};
  /// No live source observes where the arm can be within its stop (Hold), or where the path ahead
  /// leads (Slow).
  bool blind{}, blind_ahead{};
  std::uint64_t go_epoch{};             ///< motion-permission counter of the Go in force
  bool go_allowed{}, go_acknowledge{};  ///< the Go permits motion; acknowledges a fault
  std::uint64_t first_go_epoch{};       ///< of the Go received first, which permits no motion
  bool awaits_person{};                 ///< motion is not permitted until a person resumes
};

/// Result of one cycle.
struct ModeVerdict {
  Mode mode{Mode::hold};   ///< mode of this cycle
  std::uint32_t causes{};  ///< bits of Cause that hold now
};

class ModeMachine {
 public:
  explicit ModeMachine(const TimeoutSettings& timeouts) : timeouts_(timeouts) {}
  /// Advances by one cycle. Hold, Stop and Fault are latched until a newer Go permits motion; Fault
  /// until a newer Go acknowledges the fault.
  ModeVerdict update(const ModeInputs& in) noexcept;
  /// Latched mode: hold, stop or fault; normal when none is.
  Mode latched() const { return latched_; }

 private:
  TimeoutSettings timeouts_;
  Mode latched_{Mode::hold};  // normal when nothing is latched
  std::uint64_t epoch_{};     // a Go must be newer than this to resume
};

/// Returns the most severe of the causes (bits of Cause), for reports to people; none for 0.
Cause worst_of(std::uint32_t causes);

}  // namespace handsel::trajectory_controller
