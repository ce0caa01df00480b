// SPDX-License-Identifier: Apache-2.0
// The axes of a hand: where they move, what they press on, and within what limits. Pure; no heap
// after construction.
#pragma once

#include <vector>

#include "common/messages/robot.hpp"
#include "components/trajectory_controller/arm/axis_mover.hpp"

namespace handsel::trajectory_controller {

/// Axes of a hand.
struct HandAxes {
  std::vector<int> axes;             ///< of the robot
  std::vector<double> lower, upper;  ///< their bounds [rad, m]
  std::vector<char> sliding;         ///< which of them are prismatic; empty: none
};

/// One axis of a hand.
struct Finger {
  AxisMover mover;          ///< moves its set-point
  double target{};          ///< wanted now [rad, m]
  double final{};           ///< of the command, inside the bounds [rad, m]
  double direction{};       ///< of closing: -1, 0, +1
  double effort{};          ///< of the grip force [Nm, N]
  double held{};            ///< set-point that holds the object [rad, m]
  double opened{};          ///< set-point where the last closing began [rad, m]
  double grip{};            ///< direction it presses in while the object is held: -1, 0, +1
  double speed_ratio{1.0};  ///< travel relative to the farthest of all axes, (0, 1]
  double pressed_for{};     ///< it has met something for so long [s]
  bool contact{};           ///< it has met something for long enough
  /// What an angle of the settings is multiplied with, an effort divided by [-, m].
  double lever{1.0};
};

class Fingers {
 public:
  /// `comfort`, `stop`: limits of all axes of the robot; `lever`: of a sliding axis [m].
  Fingers(HandAxes hand, const KinematicLimits& comfort, const KinematicLimits& stop, double lever);

  /// Number of axes.
  std::size_t size() const noexcept { return fingers_.size(); }
  /// Robot axes of the hand.
  const std::vector<int>& axes() const noexcept { return hand_.axes; }
  /// One axis; `i` is not checked.
  Finger& operator[](std::size_t i) noexcept { return fingers_[i]; }
  /// The same.
  const Finger& operator[](std::size_t i) const noexcept { return fingers_[i]; }
  /// First axis, for loops.
  auto begin() noexcept { return fingers_.begin(); }
  /// Behind the last axis, for loops.
  auto end() noexcept { return fingers_.end(); }

  /// Returns a position of axis `i` as one inside its bounds.
  double inside(std::size_t i, double position) const noexcept;
  /// Lower bound of axis `i` [rad, m].
  double lower(std::size_t i) const noexcept { return hand_.lower[i]; }
  /// Upper bound of axis `i` [rad, m].
  double upper(std::size_t i) const noexcept { return hand_.upper[i]; }
  /// Comfort limits of axis `i`.
  AxisLimits comfort(std::size_t i) const noexcept;
  /// Stop limits of axis `i`.
  AxisLimits stop(std::size_t i) const noexcept;

  /// Begins at rest at these positions, all axes of the robot.
  void reset(const Vector& robot_position) noexcept;
  /// Every axis stops from `set_point` as fast as it can.
  void stop_from(const MotionState3& set_point) noexcept;
  /// Every axis stops; `fast`: within the stop limits, else within the comfort limits.
  void stop_all(bool fast) noexcept;
  /// Writes the axes of the set-point, `dt` [s] later.
  void advance(double dt, MotionState3& out) noexcept;
  /// Returns whether the set-points of all axes are at rest.
  bool at_rest() const noexcept;

  /// Returns what axis `i` gives to the world [Nm, N].
  double pressed(const RobotState& robot, std::size_t i) const noexcept;
  /// Returns the number of axes that press on what is held with more than `effort` [Nm].
  int count_pressing(const RobotState& robot, double effort) const noexcept;
  /// Returns whether every axis with an effort of more than `effort` [Nm] pushes with at least
  /// `ratio` of its effort.
  bool all_push(const RobotState& robot, double effort, double ratio) const noexcept;
  /// Returns the fraction of the grip force that axes give which have pressed on something for
  /// `touch_time` [s] while they closed, [0, 1].
  double fraction_in_contact(double touch_time) const noexcept;
  /// Makes the set-points and efforts of this moment those that hold the object; axes with less
  /// effort than `min_effort` [Nm, N] only hold.
  void hold_object(double min_effort) noexcept;

 private:
  HandAxes hand_;
  KinematicLimits comfort_, stop_;
  std::vector<Finger> fingers_;
};

}  // namespace handsel::trajectory_controller
