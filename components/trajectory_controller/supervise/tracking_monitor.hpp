// SPDX-License-Identifier: Apache-2.0
// Whether the arm follows its set-points. Pure, no heap.
#pragma once

#include <vector>

#include "common/geometry/pose.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_controller {

class TrackingMonitor {
 public:
  /// Error: an axis is farther than `tolerance` [rad, m] from its set-point for more than `time`
  /// [s].
  TrackingMonitor(double tolerance, double time) : tolerance_(tolerance), time_(time) {}

  /// Compares the axes of the arm, `dt` [s] after the last time. `follows`: the robot side follows
  /// set-points. Returns whether there is an error.
  bool update(const std::vector<int>& axes, const Eigen::VectorXd& measured,
              const Eigen::VectorXd& set_point, bool follows, double dt) noexcept;
  /// Axis farthest from its set-point in the last error; -1: there was none.
  int axis() const noexcept { return axis_; }
  /// How far that axis was from its set-point [rad, m].
  double distance() const noexcept { return distance_; }

 private:
  double tolerance_, time_;
  double beyond_for_{};  // [s]
  int axis_{-1};
  double distance_{};
};

}  // namespace handsel::trajectory_controller
