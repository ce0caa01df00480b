// SPDX-License-Identifier: Apache-2.0
// The arm in use and its hand: which axes they are, where they are, what the arm reaches. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/planning.hpp"
#include "common/model/manipulator.hpp"
#include "components/manipulation_planner/snapshot.hpp"

namespace handsel::manipulation_planner {

class ActiveArm {
 public:
  /// Starts with the first arm of the robot; `now` must outlive what is made.
  ActiveArm(std::shared_ptr<const RobotModel> robot, const Snapshot& now);

  /// Uses another arm, by its place in manipulators(), which must have an arm.
  void select(std::size_t index);
  /// Returns the robot.
  const RobotModel& robot() const { return *robot_; }
  /// Returns the robot for a job, which may outlive this.
  const std::shared_ptr<const RobotModel>& shared_robot() const { return robot_; }
  /// Returns all arms of the robot with their hands.
  const std::vector<Manipulator>& manipulators() const { return manipulators_; }
  /// Returns the place of the arm in use among manipulators().
  std::size_t index() const { return index_; }
  /// Returns the axes of the arm in use.
  const Group& group() const { return group_; }
  /// Returns the axes of its hand; empty: it has none.
  const Group& fingers() const { return fingers_; }
  /// Returns the link of its hand.
  int palm() const { return palm_; }
  /// Returns the name of its hand as messages have it; empty: the first hand.
  std::string hand_name() const { return index_ == 0 ? "" : fingers_.name; }
  /// Returns the state of its hand; only after a report of the controller.
  HandState hand_state() const;
  /// Sets where the fingers are moving to: motions are planned for the hand as it will be; nullopt:
  /// as it is.
  void set_finger_goal(std::optional<Vector> goal) { finger_goal_ = std::move(goal); }

  /// Returns whether the arm is at rest as commanded.
  bool at_rest() const;
  /// Returns all axes: the arms as commanded, hand and head as measured, since gripping fingers are
  /// commanded beyond what they touch [rad, m].
  Vector configuration() const;
  /// Returns the axes of the arm as commanded [rad].
  Vector joints() const { return RobotModel::part(now_.set_point(), group_); }
  /// Returns the set-point with other axes of the arm [rad, m].
  Vector set_point_with(const Vector& arm_joints) const;
  /// Returns the pose of the hand in the world, with the arm as commanded.
  Pose T_world_tool() const {
    return now_.T_world_base() * robot_->link_pose(now_.set_point(), palm_);
  }
  /// Returns the first moving link of the arm in the world [m].
  Vector3 p_world_shoulder() const;
  /// Returns axes of the arm near the present ones that put the hand there; nullopt: out of reach.
  std::optional<Vector> reach(const Pose& T_world_tool) const;
  /// Returns the direction in which the hand comes off an object it has grasped, towards the
  /// stand-off of the grasp (unit vector, tool frame).
  Vector3 direction_back(const Grasp& grasp) const;
  /// Returns the grasp for an object that is there now; nullopt: the arm does not reach it.
  std::optional<Grasp> grasp_at(const Pose& T_world_object, const Grasp& grasp) const;

 private:
  Pose T_grasp_standoff(const Grasp& grasp) const;

  std::shared_ptr<const RobotModel> robot_;
  const Snapshot& now_;
  std::vector<Manipulator> manipulators_;
  std::size_t index_{0};
  Group group_, fingers_;
  int palm_;
  std::optional<Vector> finger_goal_;
};

}  // namespace handsel::manipulation_planner
