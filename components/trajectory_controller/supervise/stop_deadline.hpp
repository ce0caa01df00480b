// SPDX-License-Identifier: Apache-2.0
// When the arm has to be at rest after it was asked to stop: by the time that its fastest stop,
// every axis by itself, would take. Pure, no heap.
#pragma once

#include <vector>

#include "common/base/time.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::trajectory_controller {

class StopDeadline {
 public:
  /// Keeps references. `axes`: of the arm; `period`: of control [s].
  StopDeadline(const RobotModel& robot, const std::vector<int>& axes, double period)
      : robot_(robot), axes_(axes), period_(period) {}

  /// Notes that nothing asks the arm to stop at this set-point.
  void set_free(const MotionState3& set_point, TimePoint now) noexcept;
  /// Returns whether the fastest stop, begun a cycle later, would end more than `slack` [s] beyond
  /// the deadline.
  bool is_due(const MotionState3& set_point, double slack, TimePoint now) const noexcept;
  /// Returns the time in which the stop limits take away the acceleration that still makes the arm
  /// faster [s].
  double ease(const MotionState3& set_point) const noexcept;

 private:
  double fastest_stop(const MotionState3& set_point) const noexcept;
  double fastest_stop_after_a_cycle(const MotionState3& set_point) const noexcept;
  double fastest_stop(int axis, double velocity, double acceleration) const noexcept;

  const RobotModel& robot_;
  const std::vector<int>& axes_;
  double period_;
  TimePoint rest_due_{};
};

}  // namespace handsel::trajectory_controller
