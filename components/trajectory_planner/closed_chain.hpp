// A second arm whose tip is rigidly joined to that of the first: two hands on one object. Own
// method. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/model/robot_model.hpp"
#include "common/model/srs_arm.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_planner {

struct JoinedArm {
  const Group* arm{};                     ///< group of the second arm; must outlive this
  Pose T_tip_follower{Pose::Identity()};  ///< tip of the first arm to that of the second
};

/// How far the tips are from being joined as they should.
struct JoinError {
  double apart{};   ///< [m]
  double turned{};  ///< [rad]
};
/// Returns distance and angle between two poses of the second tip in the frame of the first.
JoinError join_error(const Pose& T_tip_follower, const Pose& wanted);

/// The joints of the second arm for poses of the first's tip, one near the next; its elbow stays at
/// the angle it has at the start.
class ClosedChain {
 public:
  /// `start`: all axes. Keeps references to robot and group.
  ClosedChain(const RobotModel& robot, const JoinedArm& joined, const Vector& start);
  ClosedChain(const ClosedChain&) = delete;
  ClosedChain& operator=(const ClosedChain&) = delete;

  /// Returns why the arm cannot follow, one sentence; empty: it can. The tips must be joined at the
  /// start as they are said to be.
  std::string objection(const Pose& T_root_tip) const;
  /// Returns the robot axes of the second arm, in the order of joints().
  const std::vector<int>& axes() const { return joined_.arm->axes; }
  /// Joints of the second arm after the last follow() that was true [rad].
  const Vector& joints() const { return q_; }
  /// Returns the arm to its joints at the start; the next follow() is near those.
  void restart() { q_ = start_; }
  /// Moves joints() to the next pose of the first tip. False where the arm does not reach, meets a
  /// limit or a joint would jump by more than `largest_step` [rad]: `why` says so. Only after
  /// objection() was empty.
  bool follow(const Pose& T_root_tip, double largest_step, std::string& why);
  /// Returns how far the second tip is from its wanted pose for a pose of the first tip. `joints`:
  /// of the second arm [rad].
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
