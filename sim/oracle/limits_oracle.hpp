// Checks the stream of set-points against the guard limits, exactly. Own method: independent of how
// the set-points were made.
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
/// <= p <= upper at each. The period is the usual one that most intervals between the set-points'
/// stamps (arrivals where there are none) are near, once 100 have come, 3200 where a stalling
/// machine leaves it unclear; the continuity of those is checked too, once it is known. From one
/// writer's set-point to another's, and to one whose sequence number has not grown, the time is
/// unknown: the step must be possible within a time between 0 and the one between the two
/// arrivals plus a period (0.02 s while the period is not known). A stream that starts anew after
/// a silence beyond the watch must continue from the configuration of the robot, or of its servos.
class LimitsOracle {
 public:
  /// A set-point, checked when the period is known.
  struct Held {
    JointCommand command;  ///< as received
    double time{};         ///< [s] of whichever clock
    bool continues{};      ///< same writer as the one before, greater sequence number
  };

  LimitsOracle(const RobotModel&, double restart_after, double period = 0);

  /// Checks a set-point that arrives at `now` [s]; one without values for all axes is ignored.
  /// `actual`: measured positions; `held`: what the servos hold; all axes.
  void observe(const JointCommand&, std::uint64_t writer, double now, const Vector& actual,
               const Vector& held);
  /// Checks a set-point where the servos hold the measured positions.
  void observe(const JointCommand& c, std::uint64_t writer, double now, const Vector& actual) {
    observe(c, writer, now, actual, actual);
  }

  double ratio_velocity() const { return ratios_[0]; }      ///< largest |velocity| / limit so far
  double ratio_acceleration() const { return ratios_[1]; }  ///< the same of the acceleration
  double ratio_jerk() const { return ratios_[2]; }  ///< the same of the jerk between set-points
  /// Set-points that broke a bound by more than 1e-6 of it.
  std::uint64_t violations() const { return violations_; }
  const std::string& last_violation() const { return last_; }  ///< one sentence; empty: none
  std::uint64_t count() const { return count_; }               ///< set-points checked so far
  std::uint64_t writers() const { return writers_.size(); }    ///< different writers so far
  double max_gap() const { return max_gap_; }                  ///< between arrivals so far [s]
  double period() const { return period_; }                    ///< 0 while not known

 private:
  /// Time between two set-points of a stream by their sequence numbers [s].
  double between(const JointCommand& from, const JointCommand& to) const;
  void check_step(const JointCommand& from, const JointCommand& to, double t);
  /// Checks a step that took a time unknown but for its bound T [s].
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
  std::string last_;
};

}  // namespace handsel::sim
