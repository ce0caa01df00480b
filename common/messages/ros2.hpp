// Messages of ROS 2 that the lane to it speaks, as values. SI units; names as they come.
#pragma once

#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel::ros2 {

/// sensor_msgs/JointState.
struct JointState {
  Stamp stamp{};  ///< [ns]; 0: none
  std::vector<std::string> names;
  Vector position, velocity, effort;  ///< one a name, or empty: not told
};

struct TrajectoryPoint {
  Vector positions;
  double time_from_start{};  ///< [s]
};

/// trajectory_msgs/JointTrajectory; velocities, accelerations and efforts of the points are not taken over.
struct JointTrajectory {
  Stamp stamp{};  ///< when it shall begin [ns]; 0: now
  std::vector<std::string> joint_names;
  std::vector<TrajectoryPoint> points;
};

struct Transform {
  Stamp stamp{};
  std::string parent, child;  ///< frames, without a leading slash
  Pose T_parent_child{Pose::Identity()};
};

/// tf2_msgs/TFMessage.
struct Transforms {
  std::vector<Transform> transforms;
};

/// hri_msgs/IdsList.
struct Ids {
  Stamp stamp{};
  std::vector<std::string> ids;
};

/// std_msgs/String.
struct Text {
  std::string data;
};

}  // namespace handsel::ros2
