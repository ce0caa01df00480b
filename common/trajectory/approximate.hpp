// Compact approximation of a sampled trajectory by three-segment pieces (chapter section 4.6.2, TR_app).
#pragma once

#include <string>
#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace handsel {

struct ApproximationTolerance {
  double position{1e-3};  ///< largest error on every axis [rad]
  double velocity{1e-2};  ///< [rad/s]
};

struct Approximation {
  Trajectory trajectory;  ///< meets the samples at the ends of every piece; limits are not bounded: check them
  std::string reason;     ///< why there is none; empty when there is
  int pieces{};
  double compression{};                       ///< numbers in the samples / numbers in the trajectory
  double position_error{}, velocity_error{};  ///< largest at the samples
  bool ok() const { return reason.empty(); }
};

/// One piece from end to end; where a sample is off by more than the tolerance, the piece is split in two, and so on. `times` grow.
Approximation approximate(const std::vector<double>& times, const std::vector<MotionState3>& samples, const ApproximationTolerance&);

}  // namespace handsel
