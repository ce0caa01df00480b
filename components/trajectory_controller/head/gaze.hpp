// SPDX-License-Identifier: Apache-2.0
// Head angles at which the camera views a point, and whether the head may turn there. Pure.
#pragma once

#include <utility>
#include <vector>

#include "common/model/robot_capsules.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::trajectory_controller {

/// Positions of the axes of `head` (inside their bounds) that bring the x axis of the robot's gaze
/// link nearest to pointing at `p_root` (root frame [m]), the other axes as in `q`. Returns the
/// present ones when the robot has no gaze link.
std::vector<double> aim(const RobotModel& robot, const Group& head, const Vector& q,
                        const Vector3& p_root);

/// Keeps a head that turns off the arms and hands, which are planned around a head that stands. By
/// capsules, and only pairs of links that are tested against each other at all. Own method.
class HeadRoom {
 public:
  /// `min_clearance`: distance that the head keeps [m].
  HeadRoom(const RobotModel& robot, double min_clearance);
  /// Min distance between the head and the links moved by other axes [m]; +inf without one of both.
  double clearance(const Vector& q);
  /// Returns whether the head keeps `min_clearance`, or the distance it has if smaller, while its
  /// axes move from q to `target`.
  bool lets_turn(const Vector& q, const std::vector<double>& target);
  /// Returns whether the head at `target` keeps this distance with the other axes at `q`.
  bool lets_be(const Vector& q, const std::vector<double>& target);

 private:
  double min_clearance(const Vector& q);

  const RobotModel& robot_;
  double min_clearance_;
  const Group* head_;
  std::vector<LinkCapsule> capsules_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // of capsules_: head, rest
  std::vector<Pose> T_root_link_;
};

}  // namespace handsel::trajectory_controller
