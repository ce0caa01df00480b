// SPDX-License-Identifier: Apache-2.0
// Runs along trajectories by time scaling (common/trajectory/time_scaling), switches from one to
// the next, and checks every step before it is taken. No heap in step() and look(), noexcept.
#pragma once

#include <algorithm>
#include <string>

#include "common/trajectory/time_scaling.hpp"

namespace handsel::trajectory_controller {

/// What a path may use.
struct PathLimits {
  KinematicLimits motion;        ///< of its axes: no set-point exceeds them
  Eigen::VectorXd lower, upper;  ///< bounds of connecting motions; none where lower >= upper
};

/// How trajectories are joined.
struct PathRunnerSettings {
  double period{0.001};     ///< of control [s]
  double join_time{0.5};    ///< a trajectory that begins nearly as the axes move: within this [s]
  double rejoin_time{0.4};  ///< rejoin(): within this; later switch points cut corners [s]
  int rejoin_tries{10};     ///< max switch points that it tries, limited by the time of a cycle
  double alike_distance{0.02};  ///< of a trajectory that begins nearly as the axes move [rad]
  double alike_ratio{0.1};      ///< max fraction of the limits by which its motion then differs
};

class PathRunner {
 public:
  explicit PathRunner(const PathRunnerSettings& settings) : settings_(settings) {}

  /// From rest at its beginning, at once with factor 1. Empty, or why it cannot be run. May
  /// allocate.
  std::string start(const Trajectory& trajectory, const PathLimits& limits);
  /// Another factor, in [0, 1], before the first step from rest; elsewhere nothing happens.
  void begin_with(double factor) noexcept { scaling_.begin_with(factor); }
  /// Switches to `next` at the switch point `leave` on time() [s] (at once when that is past), over
  /// the fastest connecting motion that joins it no farther than `reach` [rad] from there in any
  /// axis, at its beginning when the present path is run to its end; the factor is kept. Empty, or
  /// why not; then nothing has changed. May allocate.
  std::string switch_at(double leave, const Trajectory& next, double reach);
  /// The same from any state of the axes, whatever ran before.
  std::string start_from(const MotionState3& state, const Trajectory& next, double reach);
  /// From rest a little beside the path back onto it, a little further on. False: it cannot be
  /// joined again. No heap.
  bool rejoin(const MotionState3& state) noexcept;
  /// By how much rejoin() has moved the times of the path [s].
  double rejoin_shift() const noexcept { return shift_; }
  /// One period later, the factor led toward `wanted` in [-1, 1]. False when the step would break a
  /// limit: the caller stops from state().
  bool step(double wanted) noexcept;

  /// Position, velocity and acceleration of the path at `time` [s] at full speed.
  void observe(double time, MotionState3& out) noexcept {
    scaling_.path().evaluate(time, cursor_, out);
  }
  /// Set-point after the last step: position, velocity and acceleration of the axes of the path.
  const MotionState3& state() const noexcept { return state_; }
  /// Whole path, connecting motions included. May allocate.
  const Trajectory& path() const;
  /// Time along the path at full speed [s], >= 0.
  double time() const noexcept { return std::max(0.0, scaling_.time()); }
  /// Value of time() at the beginning of the trajectory that was given last [s].
  double offset() const noexcept { return scaling_.time() - scaling_.own_time(); }
  /// Switch point from the trajectory before, as a value of time() [s].
  double switched_at() const noexcept { return scaling_.switched_at(); }
  /// Speed factor in force, alpha, in [-1, 1]; negative: back along the path.
  double factor() const noexcept { return scaling_.alpha(); }
  /// Duration of the whole path at full speed [s]; 0 before the first start.
  double duration() const noexcept { return axes() > 0 ? scaling_.duration() : 0.0; }
  /// Number of axes of the path; 0 before the first start.
  int axes() const noexcept { return static_cast<int>(state_.position.size()); }
  /// Returns whether the end of the path is reached; true before the first start.
  bool finished() const noexcept { return finished_; }
  /// Returns whether the speed factor and its rate are 0, so that no axis moves.
  bool standing() const noexcept { return scaling_.standing(); }

 private:
  template <class Switch>
  std::string switch_to(const MotionState3& from, const Trajectory& next, double reach,
                        bool from_rest, Switch&& go);
  std::string why_out_of_bounds() const;

  PathRunnerSettings settings_;
  PathLimits limits_;
  TimeScaling scaling_;
  mutable Trajectory path_;  // as law_ has it, unless stale
  mutable bool stale_{};
  double shift_{};
  int cursor_{};
  bool finished_{true};
  MotionState3 state_;
};

}  // namespace handsel::trajectory_controller
