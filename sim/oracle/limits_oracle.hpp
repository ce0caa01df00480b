// SPDX-License-Identifier: Apache-2.0
// Checks the stream of set-points exactly against the guard limits. Own method: independent of how
// the set-points are computed.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>

#include "common/messages/robot.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::sim {

/// Between two set-points n periods h apart, with t = n h and |jerk| <= J: |a1 - a0| <= J t, |v1
/// - v0 - a0 t| <= J t^2/2, |p1 - p0 - v0 t - a0 t^2/2| <= J t^3/6; and |v| <= V, |a| <= A, lower
/// <= p <= upper at each. The period is the standard period nearest to the majority of intervals
/// between the set-points' stamps (arrivals, without stamps), after 100 set-points, or 3200 on a
/// machine with delays; then the continuity of these set-points is checked as well. Between
/// set-points of two writers, or without an increase of the sequence number, the time is unknown:
/// the step must be possible within a time from 0 to the interval of the arrivals plus a period
/// (0.02 s while the period is unknown). A stream that restarts after a gap of more than
/// restart_after must continue from the configuration of the robot or of the servos.
class LimitsOracle {
 public:
  /// A set-point that waits until the period is known.
  struct Held {
    JointCommand command;  ///< as received
    double time{};         ///< stamp or time of arrival [s]
    bool continues{};      ///< same writer as the previous set-point and a greater sequence number
  };

  LimitsOracle(const RobotModel&, double restart_after, double period = 0);

  /// Checks a set-point that arrives at `now` [s]; ignores a set-point without values for all axes.
  /// `actual`: measured positions; `held`: positions held by the servos; all axes.
  void observe(const JointCommand&, std::uint64_t writer, double now, const Vector& actual,
               const Vector& held);
  /// Checks a set-point; the servos hold the measured positions.
  void observe(const JointCommand& c, std::uint64_t writer, double now, const Vector& actual) {
    observe(c, writer, now, actual, actual);
  }

  double ratio_velocity() const { return ratios_[0]; }      ///< max |velocity| / limit so far
  double ratio_acceleration() const { return ratios_[1]; }  ///< max |acceleration| / limit so far
  double ratio_jerk() const { return ratios_[2]; }          ///< max |jerk| / limit so far
  /// Returns the number of set-points beyond a bound by more than 1e-6 of the bound.
  std::uint64_t violations() const { return violations_; }
  const std::string& first_violation() const { return first_; }  ///< one sentence; empty: none
  std::uint64_t count() const { return count_; }                 ///< set-points checked so far
  std::uint64_t writers() const { return writers_.size(); }      ///< different writers so far
  double max_gap() const { return max_gap_; }  ///< max gap between arrivals so far [s]
  double period() const { return period_; }    ///< [s]; 0: unknown so far

 private:
  /// Returns the time between two set-points of a stream by their sequence numbers [s].
  double between(const JointCommand& from, const JointCommand& to) const;
  void check_step(const JointCommand& from, const JointCommand& to, double t);
  /// Checks a step of unknown duration of at most T [s].
  void check_change(const JointCommand& from, const JointCommand& to, double T);
  void check_bounds(const JointCommand&);
  void violated(const char* what, Eigen::Index axis, double value, double bound);

  const RobotModel& model_;
  KinematicLimits limits_;
  double restart_after_, period_, max_gap_{0}, last_time_{0};
  std::array<double, 3> ratios_{};
  std::uint64_t violations_{0}, count_{0}, last_writer_{0};
  bool bad_{false};
  std::set<std::uint64_t> writers_;
  std::vector<Held> waiting_;
  JointCommand previous_;
  std::string first_;
};

}  // namespace handsel::sim
