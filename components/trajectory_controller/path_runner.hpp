// Runs along one trajectory by the time law (common/trajectory/time_law) and looks at every step before it is taken.
// No heap in step(), noexcept.
#pragma once

#include <algorithm>
#include <string>

#include "common/trajectory/time_law.hpp"

namespace handsel::trajectory_controller {

class PathRunner {
 public:
  explicit PathRunner(double period) : dt_(period) {}

  /// From rest at its beginning, at once with `factor` in [0, 1]. `limits` of its axes: no set-point exceeds them. Empty, or why it
  /// cannot be run. May allocate.
  std::string start(const Trajectory& trajectory, const KinematicLimits& limits, double factor);
  /// One period later, the factor led toward `wanted` in [-1, 1]. False when the step would break a limit: the caller stops from state().
  bool step(double wanted) noexcept;

  const MotionState3& state() const noexcept { return state_; }
  const Trajectory& trajectory() const noexcept { return trajectory_; }
  double time() const noexcept { return std::max(0.0, law_.time()); }  ///< along the path [s]
  double factor() const noexcept { return law_.alpha(); }              ///< alpha
  double duration() const noexcept { return trajectory_.size() > 0 ? law_.duration() : 0.0; }
  bool finished() const noexcept { return finished_; }
  bool standing() const noexcept { return law_.standing(); }

 private:
  double dt_;
  Trajectory trajectory_;
  KinematicLimits limits_;
  TimeLaw law_;
  bool finished_{true};
  MotionState3 state_;
};

}  // namespace handsel::trajectory_controller
