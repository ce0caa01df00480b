// SPDX-License-Identifier: Apache-2.0
// Configurations of an arm whose hand stays on an object that is carried along a path: what a
// closed chain of two arms can follow from its start to its end. Own method. Pure.
#pragma once

#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::grasp_planner {

struct CarriedMotion {
  std::vector<Vector> joints;  ///< arm axes at each pose of the path [rad]
  double room{};               ///< min distance of a joint from its limits on the path [rad]
};

struct CarriedSettings {
  /// Number of elbow angles tried; the angle is constant along the path.
  int elbows{24};
  double min_room{0.06};  ///< [rad]
  /// Max step of a joint between two poses; more is a jump between branches [rad].
  double largest_step{0.5};
};

/// Returns poses of the object along straight segments between `corners`, at most `step` [m] (or
/// 5 * step [rad]) apart.
std::vector<Pose> path_of_object(const std::vector<Pose>& corners, double step);

/// Returns the motions on which the arm's tip goes through all of these poses without a jump, the
/// roomiest first; none for an arm that is not one of shoulder, elbow and wrist. `q`: all axes,
/// where the others are.
std::vector<CarriedMotion> carried_motions(const RobotModel& robot, const Group& arm,
                                           const Vector& q, const std::vector<Pose>& T_root_tip,
                                           const CarriedSettings& settings = {});

}  // namespace handsel::grasp_planner
