// Compact approximation of a sampled trajectory by three-segment pieces (chapter section 4.6.2, TR_app), and the time function alpha that
// slows samples down where axes exceed their limits.
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
  Trajectory trajectory;                      ///< meets the samples at the ends of every piece; limits are not bounded: check them
  std::string reason;                         ///< why there is none; empty when there is
  int pieces{};                               ///< of three segments on every axis
  double compression{};                       ///< numbers in the samples / numbers in the trajectory
  double position_error{}, velocity_error{};  ///< largest at the samples
  bool ok() const { return reason.empty(); }
};

/// One piece from end to end; where a sample is off by more than the tolerance, the piece is split in two, and so on; then neighbours are
/// joined again where one piece does for both. `times` grow.
Approximation approximate(const std::vector<double>& times, const std::vector<MotionState3>& samples, const ApproximationTolerance&);

struct Derived {
  std::vector<MotionState3> samples;
  std::string reason;  ///< why there are none; empty when there are
  bool ok() const { return reason.empty(); }
};

/// Velocity and acceleration of sampled positions: the least-squares cubic through each sample and `reach` neighbours on either side.
/// Positions are those of the cubic too. At least 4 samples. Reach 2 for exact samples; more takes out the noise of measured ones.
Derived differentiate(const std::vector<double>& times, const std::vector<Eigen::VectorXd>& positions, int reach = 2);

struct SlowedDown {
  std::vector<double> times;          ///< later instants of the same positions [s], from the first time on
  std::vector<MotionState3> samples;  ///< velocity and acceleration as they are then
  std::vector<double> alpha;          ///< time increment at each sample, in (0, 1]
  std::string reason;                 ///< why there are none; empty when there are
  bool ok() const { return reason.empty(); }
};

/// alpha(t) of the chapter: 1 where every axis keeps its limits, smoothly less around places where one does not, so that velocity,
/// acceleration and the change of acceleration from sample to sample are within the limits (ours).
SlowedDown slow_down(const std::vector<double>& times, const std::vector<MotionState3>& samples, const KinematicLimits& limits);

struct Executable {
  Approximation approximation;  ///< its trajectory keeps the limits, exactly
  double slowest{1};            ///< least alpha
  double stretch{1};            ///< by which the whole was then lengthened because pieces exceed what samples did not
  std::vector<double> times;    ///< when it meets each sample [s]
};

/// Both: slowed down where needed, approximated, and inside the limits at every instant.
Executable approximate_within(const std::vector<double>& times, const std::vector<MotionState3>& samples, const ApproximationTolerance&,
                              const KinematicLimits& limits);

}  // namespace handsel
