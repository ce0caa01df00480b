// SPDX-License-Identifier: Apache-2.0
// Kinematics of the arm of a Cartesian motion, on a platform that may move.
#pragma once

#include <array>
#include <optional>

#include "common/model/srs_arm.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"

namespace handsel::trajectory_planner {

class CartesianArm {
 public:
  /// Keeps references to the robot and the request, which must be checked.
  CartesianArm(const RobotModel& robot, const Group& group, const CartesianRequest& request);

  /// Returns whether the arm consists of shoulder, elbow and wrist, as srs() and advance() require.
  bool recognised() const { return arm_.has_value(); }
  /// Returns the chain of the arm at the platform's start pose.
  const ik::Chain& chain() const { return chain_; }
  /// Returns the closed-form kinematics of the arm.
  const ik::SrsArm& srs() const { return *arm_; }
  /// Returns the pose of the tool for chain() and srs(), `also` the positions of the further axes.
  Pose for_arm(const Pose& T_root_tool, const Vector& also) const;
  /// Returns a penalty: 0 in the middle of each joint's range, with a steep increase at its ends.
  double near_limits(const ik::Axes& q) const;
  /// Moves q to the nearest configuration for this pose; returns false if none is within
  /// `largest_step`.
  bool advance(const Pose& T, double elbow, const Vector& also, double largest_step,
               ik::Axes& q) const;

 private:
  /// Returns the index of a robot axis among the further active axes; -1: none.
  int further(int axis) const;
  bool drives() const { return platform_[0] >= 0 || platform_[1] >= 0 || platform_[2] >= 0; }
  Pose base_at(const Vector& also) const;

  const RobotModel& robot_;
  const CartesianRequest& request_;
  ik::Chain chain_;
  std::optional<ik::SrsArm> arm_;
  std::array<int, 3> platform_{-1, -1, -1};  // x, y, heading among the further axes
  Pose T_root_base_{Pose::Identity()};
};

}  // namespace handsel::trajectory_planner
