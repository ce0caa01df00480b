// SPDX-License-Identifier: Apache-2.0
// The arm on its path: begins, switches and ends trajectories, stops beside the path in time and
// rejoins it. A path may move axes of hands and head too, from its begin until the arm rests and
// the path is over. Pure; no heap in step(), rejoin() and path_at().
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/trajectory_controller/arm/axis_movers.hpp"
#include "components/trajectory_controller/arm/command_queue.hpp"
#include "components/trajectory_controller/arm/path_runner.hpp"
#include "components/trajectory_controller/output/set_points.hpp"

namespace handsel::trajectory_controller {

/// What the arm does.
enum class ArmState : std::uint8_t {
  at_rest,   ///< at rest, or moved by compliance or toward the robot's own reference
  running,   ///< along its path
  stopping,  ///< beside its path, every axis by itself
};

/// What becomes of the path.
enum class PathGoal : std::uint8_t {
  end,     ///< it is run to its end
  stop,    ///< the arm comes to rest on it, as commanded
  rejoin,  ///< the arm left it to stop in time, and goes back to it
};

/// What the arm is to do in a cycle.
enum class ArmOrder : std::uint8_t {
  run,    ///< along the path
  leave,  ///< stop beside the path, and rejoin it later
  stop,   ///< stop beside the path, and give it up
};

/// How far trajectories may begin from where the arm is.
struct ArmSettings {
  double period{0.001};          ///< of control [s]
  double start_tolerance{0.05};  ///< from rest [rad]
  double switch_reach{0.3};      ///< in motion, from the switch point [rad]
  double join_time{0.5};         ///< in motion, one that begins nearly as the arm moves [s]
  double rejoin_time{0.4};       ///< of a path that is rejoined after a stop beside it [s]
  int rejoin_tries{10};          ///< max switch points that are tried then
  double alike_distance{0.02};   ///< of a trajectory that begins nearly as the arm moves [rad]
  double alike_ratio{0.1};       ///< max fraction of the limits by which its motion then differs
};

class ArmMotion {
 public:
  /// Keeps a reference to the robot. `axes`: those that only trajectories move.
  ArmMotion(const ArmSettings& settings, const RobotModel& robot, const std::vector<int>& axes);

  /// Returns whether a command would be joined in motion; else it begins from rest.
  bool joins(const TrajectoryCommand& command) const noexcept;
  /// Runs a trajectory: from rest, with a short motion to its start where that is a little off; in
  /// motion by a switch, or it waits. The head may be in motion
  /// where the arm rests: it comes to rest at the start of the trajectory first. Returns why not,
  /// one sentence; then nothing has changed.
  std::string accept(const TrajectoryCommand& command, const MotionState3& sent);
  /// Comes to rest on the path, and gives it up.
  void cancel() noexcept;
  /// Speed factor before the first step from rest.
  void begin_with(double factor) noexcept { runner_.begin_with(factor); }

  /// Is at rest at the set-point.
  void rest_at(const Vector& position) noexcept;
  /// Every axis stops from the set-point as fast as it can.
  void stop_from(const MotionState3& sent) noexcept;
  /// The path is not run to its end. `rejoin`: it is rejoined after a stop beside it, unless it was
  /// to be stopped on; else it is given up.
  void interrupt_path(bool rejoin) noexcept;
  /// Rejoins the path from rest beside it. Returns whether it runs; else it is given up.
  bool rejoin(const MotionState3& sent) noexcept;
  /// Advances by a period and writes the next set-point. On the path the speed factor is led toward
  /// `wanted`; a step that would break a limit is a stop beside it.
  void step(ArmOrder order, double wanted, SetPoints& set_points) noexcept;

  /// What the arm does.
  ArmState state() const noexcept { return state_; }
  /// What becomes of the path.
  PathGoal goal() const noexcept { return goal_; }
  /// Returns whether the arm moves along its path.
  bool running() const noexcept { return state_ == ArmState::running; }
  /// Returns whether the arm moves along its path, or will after it has rejoined it.
  bool active() const noexcept { return running() || goal_ == PathGoal::rejoin; }
  /// State of the trajectory that was accepted last.
  MotionState motion() const noexcept { return motion_; }
  /// Speed factor on the path, in [-1, 1]; 0 when no path runs.
  double speed_factor() const noexcept { return running() ? runner_.factor() : 0.0; }
  /// The path, with the time along it.
  const PathRunner& path() const noexcept { return runner_; }
  /// Robot axes of the path.
  const std::vector<std::uint32_t>& path_axes() const noexcept { return path_axes_; }
  /// Commands that the path is made of.
  const CommandQueue& queue() const noexcept { return queue_; }
  /// Movers of the axes whose set-points are written here: those that only trajectories move, and
  /// those of the path.
  AxisMovers& movers() noexcept { return movers_; }
  /// Returns the state of the axes of the path at `time` [s] at full speed, valid until the next
  /// call.
  const MotionState3& path_at(double time) noexcept;

 private:
  std::string start(const TrajectoryCommand& command, const MotionState3& sent);
  std::string switch_to(const TrajectoryCommand& command, const MotionState3& sent);
  std::string switch_from_stop(const TrajectoryCommand& command, const MotionState3& sent);
  void write_path(MotionState3& next) noexcept;

  ArmSettings settings_;
  const RobotModel& robot_;
  AxisMovers movers_;
  PathRunner runner_;
  std::vector<std::uint32_t> path_axes_;
  CommandQueue queue_;
  ArmState state_{ArmState::at_rest};
  PathGoal goal_{PathGoal::end};
  MotionState motion_{MotionState::idle};
  MotionState3 sample_;  // of the axes of the path
};

/// Returns positions of all axes along the rest of the path, evenly in time and up to its end, the
/// axes beside it as in `q`; nothing when no path runs. Uses heap.
std::vector<Vector> positions_ahead(ArmMotion& arm, const Vector& q);

}  // namespace handsel::trajectory_controller
