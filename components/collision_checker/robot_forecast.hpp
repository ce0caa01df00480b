// SPDX-License-Identifier: Apache-2.0
// Where other robots are expected to be, and how near the arm comes to them. Pure. Own method.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel::collision_checker {

/// A link and another robot at their min distance.
struct RobotApproach {
  double distance{std::numeric_limits<double>::infinity()};  ///< [m]; +inf: no other robot
  std::string link, robot;                                   ///< names; empty: no other robot
};

class RobotForecast {
 public:
  /// `ahead`: max time for which other robots are expected to keep their velocity [s]. `robot` must
  /// outlive this.
  RobotForecast(const RobotModel& robot, double ahead);

  /// Replaces the other robots.
  void set(const std::vector<OtherRobot>& robots) { others_ = robots; }
  /// Returns the nearest approach of the links that an axis moves. `q`: all axes; `time`: from now
  /// until the robot is there [s].
  RobotApproach approach(const Vector& q, const Pose& T_world_base, double time);

 private:
  const RobotModel& robot_;
  double ahead_;
  std::vector<OtherRobot> others_;
  std::vector<LinkCapsule> capsules_;  // on links that an axis moves
  std::vector<Pose> links_;
};

}  // namespace handsel::collision_checker
