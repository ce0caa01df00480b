// Runs along one trajectory with a changing factor alpha = d(path time)/dt, so that every axis keeps its limits all the time.
// Time law of formulas section 1: v = alpha q', a = alpha^2 q'' + alpha' q'. The bounds on alpha' and alpha'' follow from the state, not
// from the whole path, so that slowing takes about as long as a minimum-time stop (ours). No heap in step(), noexcept.
#pragma once

#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_controller {

class PathRunner {
 public:
  explicit PathRunner(double period) : dt_(period) {}

  /// From rest at its beginning. `limits` of its axes: no set-point exceeds them. May allocate.
  void start(const Trajectory& trajectory, const KinematicLimits& limits);
  /// One period later, the factor led toward `wanted` in [-1, 1]. False when no factor keeps the limits: the caller stops from state().
  bool step(double wanted) noexcept;

  const MotionState3& state() const noexcept { return state_; }
  const Trajectory& trajectory() const noexcept { return trajectory_; }
  double time() const noexcept { return time_; }      ///< along the path [s]
  double factor() const noexcept { return factor_; }  ///< alpha
  double duration() const noexcept { return duration_; }
  bool finished() const noexcept { return finished_; }
  bool standing() const noexcept { return factor_ == 0.0 && rate_ == 0.0; }

 private:
  void sample(double time, double factor, double rate) noexcept;

  double dt_;
  Trajectory trajectory_;
  KinematicLimits limits_;
  double duration_{}, time_{}, factor_{}, rate_{};
  bool finished_{true};
  MotionState3 state_, next_, path_;
};

}  // namespace handsel::trajectory_controller
