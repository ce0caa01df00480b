// SPDX-License-Identifier: Apache-2.0
// Goals as tool poses: one pose, the poses of a set of grasps, or regions around poses. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::path_planner {

/// Goal pose of the group's tip, with a region around it.
struct PoseGoal {
  Pose T_root_tip{Pose::Identity()};  ///< pose of the tip, frame of the root link
  Vector3 slack{Vector3::Zero()};     ///< half extents of a box along the pose's axes [m]
  double turn{};                      ///< max rotation about the pose's z axis [rad]
};

struct PoseGoals {
  /// Configurations of the group, by pose; within the limits, not checked for collisions.
  std::vector<Vector> goals;
  std::vector<std::size_t> pose;  ///< index of the pose of each goal
  std::string reason;             ///< why there is no goal, one sentence
};

/// Returns up to `each` configurations per pose: the nearest to `q_start` first, then from random
/// seeds and poses of the region.
PoseGoals reach(const RobotModel& robot, const Group& group, const std::vector<PoseGoal>& poses,
                const Vector& q_start, std::uint64_t seed, int each = 8);

}  // namespace handsel::path_planner
