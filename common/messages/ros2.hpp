// SPDX-License-Identifier: Apache-2.0
// Messages of ROS 2 that ros2_lane exchanges, as values. SI units; names as received.
#pragma once

#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel::ros2 {

/// sensor_msgs/JointState.
struct JointState {
  Stamp stamp{};                   ///< [ns]; 0: none
  std::vector<std::string> names;  ///< of the joints, at most 128
  /// One per name [rad, rad/s, Nm] ([m, m/s, N]); empty: unknown.
  Vector position, velocity, effort;
};

struct TrajectoryPoint {
  Vector positions;          ///< one per joint name [rad] ([m])
  double time_from_start{};  ///< from the start of the trajectory [s]
};

/// trajectory_msgs/JointTrajectory; velocities, accelerations and efforts of the points are not
/// taken over.
struct JointTrajectory {
  Stamp stamp{};                         ///< when it shall begin [ns]; 0: now
  std::vector<std::string> joint_names;  ///< at most 128
  std::vector<TrajectoryPoint> points;   ///< in order of time, at most 1024
};

struct Transform {
  Stamp stamp{};                          ///< time of measurement [ns]; 0: none
  std::string parent, child;              ///< frames, without a leading slash
  Pose T_parent_child{Pose::Identity()};  ///< child frame in the parent frame
};

/// tf2_msgs/TFMessage.
struct Transforms {
  std::vector<Transform> transforms;  ///< at most 512
};

/// hri_msgs/IdsList.
struct Ids {
  Stamp stamp{};                 ///< stamp of the header [ns]; 0: none
  std::vector<std::string> ids;  ///< e.g. the tracked bodies
};

/// std_msgs/String.
struct Text {
  std::string data;  ///< at most 256 bytes of printable ASCII
};

}  // namespace handsel::ros2
