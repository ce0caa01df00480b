// SPDX-License-Identifier: Apache-2.0
// Commands to the trajectory controller and their acknowledgement, for the arm in use.
#pragma once

#include <cstdint>
#include <optional>

#include "common/config/settings/manipulation_planner.hpp"
#include "components/manipulation_planner/active_arm.hpp"
#include "components/manipulation_planner/clients.hpp"
#include "components/manipulation_planner/motion/motion_end.hpp"

namespace handsel::manipulation_planner {

class ControllerLink {
 public:
  /// The references must outlive what is made.
  ControllerLink(const ActiveArm& arm, const Snapshot& now, Waiting& waiting, Outbox& outbox,
                 Ids& ids, const settings::ManipulationPlannerSettings& settings)
      : arm_(arm), now_(now), waiting_(waiting), outbox_(outbox), ids_(ids), settings_(settings) {}

  /// Returns whether commands are permitted now.
  bool may_move() const;
  /// Waits until commands are permitted and the arm is at rest; false: not in time.
  Routine<bool> await_permission();
  /// Makes the failure that commands are not permitted.
  Outcome not_permitted() const;
  /// Returns the reason of the controller's mode; a sentence of its own if it is silent.
  std::string reason() const;

  /// Makes a command without trajectory, which stops the arm.
  TrajectoryCommand stop_command();
  /// Makes a command for the hand in use.
  HandCommand hand_command();
  /// Sends a hand command once.
  void send(const HandCommand& command) { outbox_.hand_commands.push_back(command); }
  /// Sends a command until the controller has acknowledged it. `command` must outlive the routine.
  Routine<Outcome> send(const TrajectoryCommand& command);
  /// Sends a command and waits for the end of its motion. `command` must outlive the routine.
  Routine<Outcome> run(const TrajectoryCommand& command);
  /// Returns how the motion of `command` ended; a motion of another command that still runs is
  /// stopped first, or it would continue while the next one is planned.
  Routine<Outcome> end_of(std::uint64_t command);
  /// Returns whether the motion of `command` has ended, or is another's by now.
  bool has_ended(std::uint64_t command) const;
  /// Ends whatever motion runs.
  Routine<Outcome> stop();

  /// Begins to stop what a dropped action has set in motion, without waiting.
  void drop_motion();
  /// Repeats the stop of drop_motion() until it is acknowledged: at first the epoch may have
  /// changed.
  void repeat_stop();

 private:
  const ActiveArm& arm_;
  const Snapshot& now_;
  Waiting& waiting_;
  Outbox& outbox_;
  Ids& ids_;
  const settings::ManipulationPlannerSettings& settings_;
  std::optional<TrajectoryCommand> dropped_stop_;
  TimePoint stop_sent_{};
};

}  // namespace handsel::manipulation_planner
