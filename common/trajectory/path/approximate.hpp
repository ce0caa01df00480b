// SPDX-License-Identifier: Apache-2.0
// Compact approximation of a sampled trajectory by three-segment pieces (chapter section 4.6.2,
// TR_app), and the time function alpha that slows samples down where axes exceed their limits.
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
  /// Meets the samples at the ends of every piece; limits are not bounded: check them.
  Trajectory trajectory;
  std::string reason;  ///< why there is none; empty when there is
  int pieces{};        ///< of three segments on every axis
  /// Numbers in the samples / numbers in the trajectory.
  double compression{};
  double position_error{}, velocity_error{};  ///< largest at the samples [rad], [rad/s]
  /// Returns whether there is a trajectory.
  bool ok() const { return reason.empty(); }
};

/// One piece from end to end; where a sample is off by more than the tolerance, the piece is split
/// in two, and so on; then neighbours are joined again where one piece does for both. `times` grow.
Approximation approximate(const std::vector<double>& times,
                          const std::vector<MotionState3>& samples, const ApproximationTolerance&);

struct Derived {
  std::vector<MotionState3> samples;  ///< one a time; without meaning when there is a reason
  std::string reason;                 ///< why there are none; empty when there are
  /// Returns whether there are samples.
  bool ok() const { return reason.empty(); }
};

/// Velocity and acceleration of sampled positions: the least-squares cubic through each sample and
/// `reach` neighbours on either side. Positions are those of the cubic too. At least 4 samples.
/// Reach 2 for exact samples; more takes out the noise of measured ones.
Derived differentiate(const std::vector<double>& times,
                      const std::vector<Eigen::VectorXd>& positions, int reach = 2);

struct SlowedDown {
  /// Later instants of the same positions [s], from the first time on.
  std::vector<double> times;
  std::vector<MotionState3> samples;  ///< velocity and acceleration as they are then
  std::vector<double> alpha;          ///< time increment at each sample, in (0, 1]
  std::string reason;                 ///< why there are none; empty when there are
  /// Returns whether there are samples.
  bool ok() const { return reason.empty(); }
};

/// alpha(t) of the chapter: 1 where every axis keeps its limits, smoothly less around places where
/// one does not, so that velocity, acceleration and the change of acceleration from sample to
/// sample are within the limits. Own method: alpha is lowered around each sample beyond a limit and
/// smoothed, until every sample keeps the limits.
SlowedDown slow_down(const std::vector<double>& times, const std::vector<MotionState3>& samples,
                     const KinematicLimits& limits);

struct Executable {
  Approximation approximation;  ///< its trajectory keeps the limits, exactly
  double slowest{1};            ///< smallest alpha
  /// Factor of the duration, > 1 where the whole was lengthened because pieces exceed what samples
  /// did not.
  double stretch{1};
  std::vector<double> times;  ///< when it meets each sample [s]
};

/// Both: slowed down where needed, approximated, and inside the limits at every instant.
Executable approximate_within(const std::vector<double>& times,
                              const std::vector<MotionState3>& samples,
                              const ApproximationTolerance&, const KinematicLimits& limits);

}  // namespace handsel
