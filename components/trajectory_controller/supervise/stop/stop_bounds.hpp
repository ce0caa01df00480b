// SPDX-License-Identifier: Apache-2.0
// Bounds of the travel and the speed of every link in two stops. Pure, no heap after construction,
// noexcept.
#pragma once

#include <vector>

#include "components/trajectory_controller/supervise/stop/moving_chain.hpp"
#include "components/trajectory_controller/supervise/stop/stop_plan.hpp"

namespace handsel::trajectory_controller {

/// By capsule of a chain, for both stops.
class StopBounds {
 public:
  /// Keeps a reference to the chain. `dof`: number of axes of the robot.
  StopBounds(const MovingChain& chain, int dof);

  /// Computes the bounds for two stops from the same set-point.
  void set(const StopPlan& one, const StopPlan& other) noexcept;
  /// Travel of a capsule [m].
  double travel(std::size_t capsule) const noexcept { return travel_[capsule]; }
  /// Surface speed of a capsule, fingers at rest [m/s].
  double carried(std::size_t capsule) const noexcept { return carried_[capsule]; }
  /// Speed of the fingers of a capsule in the hand [m/s].
  double inner(std::size_t capsule) const noexcept { return inner_[capsule]; }
  /// Returns the travel of the fingers of a capsule in the hand [m].
  double inner_travel(std::size_t capsule) const noexcept;

 private:
  const MovingChain& chain_;
  std::vector<double> travel_, carried_, inner_;
  // By axis: travel in the one stop and the other, speed in both.
  std::vector<double> axis_travel_, other_axis_travel_, axis_speed_;
};

}  // namespace handsel::trajectory_controller
