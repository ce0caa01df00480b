// SPDX-License-Identifier: Apache-2.0
// Turns the head to the gaze target of attention where the head collides with nothing there. Pure;
// no heap in step().
#pragma once

#include <vector>

#include "common/messages/attention.hpp"
#include "components/trajectory_controller/arm/axis_movers.hpp"
#include "components/trajectory_controller/head/gaze.hpp"

namespace handsel::trajectory_controller {

/// When the head turns.
struct HeadSettings {
  double period{0.001};            ///< of control [s]
  double dead_band{0.03};          ///< the head turns only for more than this [rad]
  double min_target_motion{0.02};  ///< min motion of the gaze target for another aim [m]
  double clearance{0.02};          ///< distance from other links that the head keeps [m]
};

class HeadController {
 public:
  /// Keeps a reference to the robot.
  HeadController(const RobotModel& robot, const std::vector<int>& axes,
                 const HeadSettings& settings);

  /// Turns to the gaze target of the advice if the target is new and the head collides with nothing
  /// there, with the other axes at `here` (present) and at each of `ahead` (along the path that the
  /// arm follows, to where the arm comes to rest); else keeps the target before.
  void aim_at(const AttentionAdvice& advice, const Pose& T_world_base, const Vector& here,
              const std::vector<Vector>& ahead);
  /// Starts at rest at `position` (all axes), with no gaze target.
  void reset(const Vector& position) noexcept;
  /// Writes the axes of the head of the next set-point. `may_move`: false: the head stops.
  /// `on_path`: of each axis of the robot, whether a trajectory moves it; the head rests there
  /// afterwards.
  void step(bool may_move, const std::vector<char>& on_path, MotionState3& next) noexcept;
  /// Movers of the axes of the head.
  AxisMovers& movers() noexcept { return movers_; }
  /// Returns whether the advice has a gaze target that differs from the one in force.
  bool has_new_target(const AttentionAdvice& advice) const noexcept;

 private:
  const RobotModel& robot_;
  HeadRoom room_;
  AxisMovers movers_;
  HeadSettings settings_;
  std::vector<double> target_;  // of each axis of the head; empty: none
  Vector3 aimed_at_{Vector3::Constant(1e9)};
  bool paused_{};  // in Hold and above
};

}  // namespace handsel::trajectory_controller
