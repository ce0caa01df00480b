// Turns the head to where attention looks, as far as no part of the robot is in between. Pure; no
// heap in step().
#pragma once

#include <vector>

#include "common/messages/attention.hpp"
#include "components/trajectory_controller/arm/axis_movers.hpp"
#include "components/trajectory_controller/head/gaze.hpp"

namespace handsel::trajectory_controller {

class HeadController {
 public:
  /// Keeps a reference to the robot. `dead_band`: the head turns only for more than this [rad];
  /// `period`: of control [s].
  HeadController(const RobotModel& robot, const std::vector<int>& axes, double dead_band,
                 double period);

  /// Turns to the gaze target of the advice where that is new and free of collisions, here and at
  /// `path_end`, where the arm comes to rest (both: all axes).
  void aim_at(const AttentionAdvice& advice, const Pose& T_world_base, const Vector& here,
              const Vector& path_end);
  /// Begins at rest at `position`, all axes, with no gaze target.
  void reset(const Vector& position) noexcept;
  /// Writes the axes of the head of the next set-point.
  void step(bool may_move, MotionState3& next) noexcept;
  /// Movers of the axes of the head.
  AxisMovers& movers() noexcept { return movers_; }
  /// Returns whether the advice has a gaze target that differs from the one in force.
  bool has_new_target(const AttentionAdvice& advice) const noexcept;

 private:
  const RobotModel& robot_;
  HeadRoom room_;
  AxisMovers movers_;
  double dead_band_, period_;
  std::vector<double> target_;  // of each axis of the head; empty: none
  Vector3 aimed_at_{Vector3::Constant(1e9)};
  bool paused_{};  // in Hold and above
};

}  // namespace handsel::trajectory_controller
