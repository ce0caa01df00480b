// Goals given as places of the tool: one pose, the poses of a set of grasps, or regions around
// poses. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::path_planner {

/// The group's tip is to be there, or in the region around it.
struct PoseGoal {
  Pose T_root_tip{Pose::Identity()};  ///< pose of the tip, frame of the root link
  Vector3 slack{Vector3::Zero()};     ///< half extents of a box along the pose's axes [m]
  double turn{};                      ///< about the pose's z axis in either direction [rad]
};

struct PoseGoals {
  /// Configurations of the group, by pose; inside the limits, collisions are not checked.
  std::vector<Vector> goals;
  std::vector<std::size_t> pose;  ///< which pose each of them is for
  std::string reason;             ///< when there is none
};

/// Up to `each` configurations a pose: the one nearest `q_start` first, then from random seeds and
/// places of the region.
PoseGoals reach(const RobotModel& robot, const Group& group, const std::vector<PoseGoal>& poses,
                const Vector& q_start, std::uint64_t seed, int each = 8);

}  // namespace handsel::path_planner
