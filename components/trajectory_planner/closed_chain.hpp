// SPDX-License-Identifier: Apache-2.0
// Kinematics of a second arm whose tip is rigidly joined to the first arm's tip: two hands on one
// object. Own method. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/model/robot_model.hpp"
#include "common/model/srs_arm.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_planner {

struct JoinedArm {
  const Group* arm{};                     ///< group of the second arm; must outlive this
  Pose T_tip_follower{Pose::Identity()};  ///< second tip in the frame of the first
};

/// Error between the actual and the required relative pose of the tips.
struct JoinError {
  double apart{};   ///< distance [m]
  double turned{};  ///< angle [rad]
};
/// Returns distance and angle between two poses of the second tip in the frame of the first.
JoinError join_error(const Pose& T_tip_follower, const Pose& wanted);

/// Computes the joints of the second arm for successive nearby poses of the first tip; the elbow
/// angle is that of the start.
class ClosedChain {
 public:
  /// `start`: all axes. Keeps references to robot and group.
  ClosedChain(const RobotModel& robot, const JoinedArm& joined, const Vector& start);
  ClosedChain(const ClosedChain&) = delete;
  ClosedChain& operator=(const ClosedChain&) = delete;

  /// Returns why the arm cannot follow, one sentence; empty: it can. The tips must have the
  /// required relative pose at the start.
  std::string objection(const Pose& T_root_tip) const;
  /// Returns the robot axes of the second arm, in the order of joints().
  const std::vector<int>& axes() const { return joined_.arm->axes; }
  /// Returns the joints of the second arm after the last successful follow() [rad].
  const Vector& joints() const { return q_; }
  /// Resets the arm to its joints at the start, near which the next follow() must be.
  void restart() { q_ = start_; }
  /// Moves joints() to the next pose of the first tip. Returns false, with the reason in `why`, if
  /// the pose is out of reach, at a limit, or a joint would move by more than `largest_step` [rad].
  /// Requires an empty objection().
  bool follow(const Pose& T_root_tip, double largest_step, std::string& why);
  /// Returns the error of the second tip for a pose of the first tip. `joints`: of the second arm
  /// [rad].
  JoinError error(const Pose& T_root_tip, const Vector& joints) const;

 private:
  const RobotModel& robot_;
  JoinedArm joined_;
  ik::Chain chain_;
  std::optional<ik::SrsArm> arm_;
  Vector start_, q_;
  double elbow_{};
};

}  // namespace handsel::trajectory_planner
