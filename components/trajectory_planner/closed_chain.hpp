// A second arm whose tip is rigidly joined to that of the first: two hands on one object (ours). Pure.
#pragma once

#include <optional>
#include <string>

#include "common/model/robot_model.hpp"
#include "common/model/srs_arm.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_planner {

struct JoinedArm {
  const Group* arm{};
  Pose T_tip_follower{Pose::Identity()};  ///< tip of the first arm to that of the second
};

/// How far the tips are from being joined as they should.
struct JoinError {
  double apart{};   ///< [m]
  double turned{};  ///< [rad]
};
JoinError join_error(const Pose& T_tip_follower, const Pose& wanted);

/// The joints of the second arm for poses of the first's tip, one near the next; its elbow stays at the angle it has at the start.
class ClosedChain {
 public:
  /// `start`: all axes. Keeps references to robot and group.
  ClosedChain(const RobotModel& robot, const JoinedArm& joined, const Vector& start);
  ClosedChain(const ClosedChain&) = delete;
  ClosedChain& operator=(const ClosedChain&) = delete;

  /// Why the arm cannot follow, one sentence; empty: it can. The tips must be joined at the start as they are said to be.
  std::string objection(const Pose& T_root_tip) const;
  const std::vector<int>& axes() const { return joined_.arm->axes; }
  const Vector& joints() const { return q_; }  ///< where it has been followed to
  void restart() { q_ = start_; }
  /// False where it does not reach, meets a limit or would jump by more than `largest_step` [rad]: `why` says so.
  bool follow(const Pose& T_root_tip, double largest_step, std::string& why);
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
