// SPDX-License-Identifier: Apache-2.0
// A stop in which every axis comes to rest by itself as fast as it can: where and how fast each
// axis is at any time of it. Pure, no heap after construction, noexcept.
#pragma once

#include <array>
#include <vector>

#include "common/model/robot_model.hpp"
#include "common/trajectory/min_time.hpp"

namespace handsel::trajectory_controller {

/// One axis from now until rest.
struct AxisStop {
  int axis{};           ///< of the robot
  bool sliding{};       ///< prismatic
  AxisState start;      ///< now
  AxisProfile profile;  ///< of the stop, after the delay
  double delay{};       ///< until the stop begins, with constant acceleration [s]
  double duration{};    ///< until rest [s]
  double travel{};      ///< of all its motion, there and back [rad, m]
  double max_speed{};   ///< [rad/s, m/s]

  /// Returns the state at time `t` after now [s].
  AxisState at(double t) const noexcept;
  /// Returns the largest speed between two times after now [s].
  double max_speed_between(double from, double to) const noexcept;
};

/// The axes that move.
class StopPlan {
 public:
  /// `sliding`: of each axis of the robot, whether it is prismatic.
  StopPlan(const RobotModel& robot, const std::vector<char>& sliding);

  /// Plans the stop from a set-point of all axes: each continues with its acceleration for `delay`
  /// [s], then stops by itself.
  void plan(const MotionState3& state, double delay) noexcept;

  /// Number of axes that move; 0: there is no stop.
  int count() const noexcept { return count_; }
  /// One of them; `k` is not checked.
  const AxisStop& operator[](int k) const noexcept { return axes_[static_cast<std::size_t>(k)]; }
  /// Time until all are at rest [s].
  double duration() const noexcept { return duration_; }
  /// Returns whether all come to rest inside their bounds.
  bool inside() const noexcept { return inside_; }
  /// Writes where the axes are at `time` [s]; of axes at rest, `position` keeps what it has.
  void position_at(double time, Vector& position) const noexcept;

 private:
  static constexpr int kMaxAxes = 64;

  bool ends_inside(int axis, double start, double end) const noexcept;

  KinematicLimits limits_;             // of the stops
  std::vector<double> lower_, upper_;  // bounds of the axes
  std::vector<char> sliding_;
  std::array<AxisStop, kMaxAxes> axes_;
  int count_{};
  double duration_{};
  bool inside_{true};
};

}  // namespace handsel::trajectory_controller
